//! Tests `report`: the page, the statements on the page, and refusals.

use crate::cli::sandbox::*;
use base64::Engine;
use serde_json::{Value, json};
use sha2::{Digest, Sha256};
use std::path::Path;
use std::sync::OnceLock;

/// Returns a sandbox with a search result in the folder `found`, which is made once. The cell is small, and
/// the search keeps three layouts.
fn shop() -> Sandbox {
    static FOUND: OnceLock<Sandbox> = OnceLock::new();
    let made = FOUND.get_or_init(|| {
        let shop = Sandbox::new();
        shop.write("cells/small.toml", SMALL);
        shop.done(&["search", "cells/small.toml", "--budget", "300", "--keep", "3", "--out", "found"]);
        shop
    });
    let shop = Sandbox::new();
    shop.write("cells/small.toml", SMALL);
    copy_folder(&made.path("found"), &shop.path("found"));
    shop
}

const SMALL: &str = "from = \"hitachi_cell.toml\"\n[operation.assembly]\ngrid = [4, 3]\n\
                     [operation.picking]\ngrid = [6, 1]\n";

/// Returns the text between the first `from` and the `to` after it.
fn between<'t>(text: &'t str, from: &str, to: &str) -> &'t str {
    let start = text.find(from).unwrap_or_else(|| panic!("no {from}")) + from.len();
    let length = text[start..].find(to).unwrap_or_else(|| panic!("no {to} after {from}"));
    &text[start..start + length]
}

/// Returns the hash with which a content security policy allows this text.
fn hash(text: &str) -> String {
    format!("'sha256-{}'", base64::engine::general_purpose::STANDARD.encode(Sha256::digest(text.as_bytes())))
}

/// Checks a page as a browser does: its policy contains the hashes of its scripts and styles, and nothing
/// uses the network.
fn assert_sound(html: &str) {
    assert!(html.len() < 8 << 20, "{} bytes", html.len());
    let policy = between(html, "Content-Security-Policy\" content=\"", "\">");
    let script = hash(between(html, "<script>", "</script>"));
    let style = hash(between(html, "<style>", "</style>"));
    assert_eq!(
        policy,
        format!(
            "default-src 'none'; script-src {script}; style-src {style}; img-src data:; base-uri 'none'; form-action 'none'"
        )
    );
    let count = |word: &str| html.matches(word).count();
    assert_eq!((count("<style"), count("</style")), (1, 1));
    // One script element contains code, and the other contains JSON.
    let body = html.replacen(between(html, "<script>", "</script>"), "", 1);
    assert_eq!((body.matches("<script").count(), body.matches("</script").count()), (2, 2));
    let json: Value = serde_json::from_str(between(html, "id=\"drawings\">", "</script>")).unwrap();
    assert_eq!(json["schema"], "sweetspot/drawing/1");
    // Outside script, style and data, nothing can run or fetch.
    let markup = body.replacen(between(&body, "id=\"drawings\">", "</script>"), "", 1);
    let markup = markup.replacen(between(&markup, "<style>", "</style>"), "", 1);
    // Names must be text: only the parts of a tag outside quoted values can be attributes.
    let tags = markup.split('<').skip(1).map(|part| part.split('>').next().unwrap_or_default());
    let bare: String = tags.map(|tag| tag.split('"').step_by(2).collect::<String>() + "\n").collect();
    for word in [" style=", " on", " src="] {
        assert!(!bare.contains(word), "{word}");
    }
    for name in bare.lines().filter_map(|tag| tag.split(' ').next()) {
        assert!(!["link", "base", "img", "iframe", "object", "embed", "form"].contains(&name), "{name}");
    }
    assert!(bare.lines().count() > 200, "only {} tags", bare.lines().count());
    assert!(!markup.contains("@import"));
    let allowed = "http://www.w3.org/2000/svg";
    assert_eq!(
        markup.matches("http").count(),
        markup.matches(allowed).count() + markup.matches("http-equiv").count()
    );
}

/// Returns the machine-readable numbers of the page, each with the label of its fact.
fn facts(html: &str) -> Vec<(String, f64)> {
    let list = between(html, "<dl class=\"facts\">", "</dl>");
    let fact = |part: &str| {
        let value =
            part.contains("<data value=").then(|| between(part, "<data value=\"", "\"").parse().unwrap())?;
        Some((between(part, "<dt>", "</dt>").to_string(), value))
    };
    list.split("</dd>").filter_map(fact).collect()
}

#[test]
fn the_verdict_of_a_report_agrees_with_the_search() {
    let shop = shop();
    let ran = shop.run(&["report", "found", "-o", "page.html", "--json"]);
    assert_eq!(ran.code, Some(0), "{}", ran.err);
    let (verdict, search) = (ran.document(), shop.document("found/search.json"));
    for key in
        ["objective_value", "gain_percent", "bound", "gap_percent", "unit", "ended", "quantity", "objective"]
    {
        assert_eq!(field(&verdict, key), field(&search, key), "{key}");
    }
    assert_eq!(verdict["start_value"], search["start"]["objective_value"]);
    assert_eq!((&verdict["answer"], &verdict["of"]), (&json!("yes"), &json!("search")));
    for (spot, operation) in items(&verdict["operations"]).iter().zip(items(&search["operations"])) {
        for key in ["name", "equipment", "sense", "value", "node", "position_mm"] {
            assert_eq!(field(spot, key), field(operation, key), "{key}");
        }
    }
    // The runner-up is the best of the other kept layouts.
    let front = items(&search["front"]).iter().filter(|f| f["layout"] != search["layout"]);
    let least = front.map(|f| number(&f["objective_value"])).fold(f64::INFINITY, f64::min);
    assert_eq!(verdict["runner_up"]["kind"], "layout");
    assert_eq!(number(&verdict["runner_up"]["value"]), least);
    let html = shop.text("page.html");
    assert_sound(&html);
    let facts = facts(&html);
    let of = |label: &str| {
        facts.iter().find(|f| f.0 == label).unwrap_or_else(|| panic!("no {label}: {facts:?}")).1
    };
    assert_eq!(of("Objective"), number(&search["objective_value"]));
    assert_eq!(of("Gain"), number(&search["gain_percent"]));
    assert_eq!(of("Proven gap"), number(&search["gap_percent"]));
    assert_eq!(of("Runner-up"), least);
    assert_corners(&html, &search["layout"]["worktable"]);
    // The command may overwrite a page but no other file.
    shop.done(&["report", "found", "-o", "page.html"]);
    let ran = shop.run(&["report", "found", "-o", "cells/small.toml"]);
    assert_eq!(ran.code, Some(2), "{}", ran.err);
    assert_eq!(shop.text("cells/small.toml"), SMALL);
}

/// Checks that the four corners of the set-out list span the table at its placement in search.json.
fn assert_corners(html: &str, at: &Value) {
    let table = between(html, "Best layout: corners", "</table>");
    let rows: Vec<Vec<f64>> =
        table.split("<tr>").skip_while(|row| !row.contains(">worktable<")).take(4).map(cells).collect();
    let mean = |k: usize| rows.iter().map(|row| row[k]).sum::<f64>() / 4.0;
    // The columns are the corner, x and y in the world, x and y from the base, and the distance for a tape
    // measure.
    assert!((mean(1) - number(&at["x_mm"])).abs() < 0.1, "{rows:?}");
    assert!((mean(2) - number(&at["y_mm"])).abs() < 0.1, "{rows:?}");
    let yaw = (rows[1][2] - rows[0][2]).atan2(rows[1][1] - rows[0][1]).to_degrees();
    assert!((yaw - number(&at["yaw_deg"])).abs() < 0.02, "{yaw}");
    for row in rows {
        assert!((row[3].hypot(row[4]) - row[5]).abs() < 0.15, "{row:?}");
    }
}

/// Returns the numbers of a table row.
fn cells(row: &str) -> Vec<f64> {
    let texts = row.split("<td").skip(1).map(|cell| between(cell, ">", "</td>"));
    texts.filter_map(|text| text.parse().ok()).collect()
}

#[test]
fn a_folder_that_was_tampered_with_is_refused() {
    let best = |shop: &Sandbox| shop.write("found/best.toml", &(shop.text("found/best.toml") + "# a note\n"));
    let search = |shop: &Sandbox| {
        let text = shop.text("found/search.json").replacen("\"gain_percent\": ", "\"gain_percent\": 9", 1);
        shop.write("found/search.json", &text);
    };
    let input = |shop: &Sandbox| {
        let path = "found/inputs/robots/hitachi_pw10.toml";
        shop.write(path, &shop.text(path).replacen("alpha", "alpha ", 1));
    };
    let lost = |shop: &Sandbox| std::fs::remove_file(shop.path("found/map.csv")).unwrap();
    type Tampering<'t> = &'t dyn Fn(&Sandbox);
    let cases: [(&str, Tampering<'_>); 4] = [
        ("best.toml", &best),
        ("search.json", &search),
        ("robots/hitachi_pw10.toml", &input),
        ("map.csv", &lost),
    ];
    for (named, tamper) in cases {
        let shop = shop();
        tamper(&shop);
        let ran = shop.run(&["report", "found"]);
        assert_eq!((ran.code, ran.out.as_str()), (Some(2), ""), "{named}: {}", ran.err);
        assert!(ran.err.contains(&format!("{named}: it")), "{named}: {}", ran.err);
        // Every command that shows the folder refuses it.
        for args in [
            ["compare", "cells/small.toml", "found"],
            ["export", "found", "--to=csv"],
            ["figures", "found", "--out=f"],
        ] {
            let ran = shop.run(&args);
            assert_eq!((ran.code, ran.out.as_str()), (Some(2), ""), "{args:?} {named}: {}", ran.err);
        }
        assert!(!shop.path("report.html").exists());
    }
}

/// Right hashes of wrong numbers are not enough, because the numbers are computed again.
#[test]
fn a_folder_whose_numbers_do_not_come_out_again_is_refused() {
    let shop = shop();
    let (text, is) =
        (shop.text("found/search.json"), shop.document("found/search.json")["objective_value"].clone());
    let better = format!("\"objective_value\": {}", number(&is) - 1.0);
    let text = text.replacen(&format!("\"objective_value\": {is}"), &better, 1);
    let old = sha256(&shop.read("found/search.json"));
    shop.write("found/search.json", &text);
    shop.write(
        "found/manifest.json",
        &resealed(&shop.text("found/manifest.json").replace(&old, &sha256(text.as_bytes()))),
    );
    let ran = shop.run(&["report", "found"]);
    assert_eq!(ran.code, Some(2), "{}", ran.err);
    assert!(ran.err.contains("search.json: it gives the objective of the best layout as"), "{}", ran.err);
}

#[test]
fn a_folder_without_a_search_result_is_refused() {
    let shop = shop();
    shop.done(&["map", PAPER, "--out", "mapped"]);
    for (args, said) in [
        (&["report", "mapped"][..], "it is not the manifest of a search"),
        (&["report", "cells"], "holds no manifest.json and no checkpoint"),
        (&["report", "found", "--sense", "xyz"], "flags cannot change the settings"),
        (&["report", "cells/small.toml", "-o", "page.txt"], "must end in .html or .htm"),
    ] {
        let ran = shop.run(args);
        assert_eq!((ran.code, ran.out.as_str()), (Some(2), ""), "{args:?}: {}", ran.err);
        assert!(ran.err.contains(said), "{args:?}: {}", ran.err);
    }
    assert_eq!(shop.run(&["report", "no/such.toml"]).code, Some(3));
}

#[test]
fn the_start_layout_is_judged_by_its_limit() {
    let shop = Sandbox::new();
    let map = shop.json(&["map", PAPER]);
    let least = number(&map["objective_mm"]);
    let cases = [(least + 0.25, 0, "met", 0.25), (least - 0.25, 1, "missed", -0.25)];
    for (limit, code, word, margin) in cases {
        let ran = shop.run(&["report", PAPER, "--limit", &limit.to_string(), "--json"]);
        assert_eq!(ran.code, Some(code), "{}", ran.err);
        let verdict = ran.document();
        assert_eq!(number(&verdict["objective_value"]), least);
        assert_eq!(verdict["requirement"], word);
        assert!((number(&verdict["operations"][0]["margin"]) - margin).abs() < 1e-8, "{verdict}");
        assert_eq!(
            verdict["operations"][0]["node"],
            json!([map["operations"][0]["best"]["i"], map["operations"][0]["best"]["j"]])
        );
    }
    // Without a limit, there is no shortfall, and the next best node is the runner-up.
    let verdict = shop.json(&["report", PAPER]);
    assert_eq!((&verdict["requirement"], &verdict["gap_percent"]), (&json!("none"), &Value::Null));
    let mut values: Vec<f64> = items(&map["operations"][0]["nodes"])
        .iter()
        .filter(|n| n["status"] == "ok")
        .map(|n| number(&n["value"]))
        .collect();
    values.sort_by(f64::total_cmp);
    assert_eq!(
        (number(&verdict["runner_up"]["value"]), &verdict["runner_up"]["kind"]),
        (values[1], &json!("node"))
    );
    assert_sound(&shop.text("report.html"));
}

#[test]
fn a_search_without_a_layout_reports_no_and_the_reason() {
    let shop = Sandbox::new();
    shop.write("cells/far.toml", BEYOND_REACH);
    assert_eq!(shop.run(&["search", "cells/far.toml", "--budget", "60", "--out", "found"]).code, Some(1));
    let ran = shop.run(&["report", "found", "--json"]);
    assert_eq!(ran.code, Some(1), "{}", ran.err);
    let (verdict, search) = (ran.document(), shop.document("found/search.json"));
    assert_eq!((&verdict["answer"], &verdict["objective_value"]), (&json!("no"), &Value::Null));
    // The reasons are those of a layout that the page does not show.
    let told = items(&search["reasons"])
        .iter()
        .map(|reason| json!(format!("in the examined layout that is closest to feasible: {}", text(reason))));
    assert_eq!(items(&verdict["reasons"]), told.collect::<Vec<_>>());
    assert!(!items(&verdict["reasons"]).is_empty());
    let html = shop.text("report.html");
    assert_sound(&html);
    assert!(html.contains("No: the search has found no feasible layout"));
    assert!(html.contains("has no usable node"));
}

#[test]
fn a_stopped_search_is_reported_as_stopped() {
    let shop = Sandbox::new();
    shop.write("cells/small.toml", SMALL);
    let args = ["search", "cells/small.toml", "--budget", "1000000", "--time", "0.3", "--out", "found"];
    assert_eq!(shop.run(&args).code, Some(4));
    let ran = shop.run(&["report", "found", "--json"]);
    assert!([Some(0), Some(1)].contains(&ran.code), "{}", ran.err);
    assert_eq!(ran.document()["ended"], "time-limit");
    assert_eq!(ran.document()["objective_value"], shop.document("found/search.json")["objective_value"]);
    assert!(shop.text("report.html").contains("The search was stopped early"));
}

/// Hostile names: unescaped, they would be markup, script, template or terminal codes.
const HOSTILE: [&str; 8] = [
    "<script>alert(1)</script>",
    "</script><img src=x onerror=alert(2)>",
    "\"><svg onload=alert(3)>",
    "' onmouseover='alert(4)",
    "{{ 7919 * 7927 }}{% raw %}",
    "</style><!--",
    "&lt;b&gt;",
    "]]><b>x</b>",
];

#[test]
fn hostile_names_are_shown_as_text_in_the_report() {
    let shop = Sandbox::new();
    let quoted = |name: &str| format!("\"{}\"", name.replace('"', "\\\""));
    let [cell, table, operation, solid, obstacle, keep_out, sense, other] = HOSTILE;
    let text = format!(
        "from = \"hitachi_paper.toml\"\nname = {cell}\n\
         [sense.{sense}]\ndirection = [1, 0, 0]\n\
         [equipment.{table}]\nsurface = {{ size_mm = [600, 600] }}\n\
         solid = [{{ name = {solid}, box = {{ centre_mm = [0, 0, -50], size_mm = [600, 600, 100] }} }}]\n\
         placement = {{ x_mm = 850, y_mm = 0, z_mm = 600 }}\n\
         [operation.{operation}]\non = {table}\ngrid = [4, 4]\nstandoff_mm = 100\nbend_deg = -90\nsense = {sense}\n\
         [operation.{other}]\non = {table}\ngrid = [2, 2]\nstandoff_mm = 100\nbend_deg = -90\nsense = \"xy\"\n\
         [obstacle.{obstacle}]\nsolid = [{{ name = {solid}, box = {{ centre_mm = [0, 0, 500], size_mm = [100, 100, 1000] }} }}]\n\
         placement = {{ x_mm = -900, y_mm = -900, z_mm = 0 }}\n\
         [keep_out.{keep_out}]\nmin_mm = [-2000, -2000, 0]\nmax_mm = [-1900, -1900, 100]\n",
        cell = quoted(cell),
        table = quoted(table),
        operation = quoted(operation),
        solid = quoted(solid),
        obstacle = quoted(obstacle),
        keep_out = quoted(keep_out),
        sense = quoted(sense),
        other = quoted(other),
    );
    shop.write("cells/hostile.toml", &text);
    // The page also shows words of the command line.
    let ran = shop.run(&["report", "cells/hostile.toml", "--package", "\u{1b}[31mred</script>=."]);
    assert!([Some(0), Some(1)].contains(&ran.code), "{}", ran.err);
    let html = shop.text("report.html");
    assert_sound(&html);
    for raw in ["<script>alert", "<img", "<svg onload", "<b>x", "</style><", "\u{1b}", "62773913"] {
        assert!(!html.contains(raw), "{raw}");
        assert!(!ran.out.contains('\u{1b}') && !ran.err.contains('\u{1b}'));
    }
    // A quotation mark is harmless in JSON but would end a value in markup.
    let markup = html.replacen(between(&html, "id=\"drawings\">", "</script>"), "", 1);
    assert!(!markup.contains("' onmouseover='"));
    // The page still shows the names as text.
    for shown in ["&lt;script&gt;alert(1)", "{{ 7919 * 7927 }}{% raw %}", "&amp;lt;b&amp;gt;"] {
        assert!(html.contains(shown), "{shown}");
    }
}

#[test]
fn a_search_ends_by_naming_the_report() {
    let shop = Sandbox::new();
    shop.write("cells/small.toml", SMALL);
    let ran = shop.done(&["search", "cells/small.toml", "--budget", "20", "--out", "found"]);
    assert!(ran.err.contains("next: sweetspot report found"), "{}", ran.err);
    assert!(Path::new(&shop.path("found/manifest.json")).is_file());
}

#[test]
fn a_comparison_page_names_the_better_layout() {
    let shop = shop();
    let ran = shop.run(&["compare", "cells/small.toml", "found", "-o", "two.html", "--json"]);
    assert_eq!(ran.code, Some(0), "{}", ran.err);
    let document = ran.document();
    let [start, best] = items(&document["layouts"]) else { panic!("{document}") };
    let html = shop.text("two.html");
    assert_sound(&html);
    let value = |layout: &Value, k: usize| number(&items(&layout["operations"])[k]["value"]);
    for k in 0..2 {
        let (x, y) = (value(start, k), value(best, k));
        let verb = if y < x { "better" } else { "worse" };
        let by = match x.max(y) / x.min(y) {
            ratio if ratio < 1.005 => continue,
            ratio if ratio < 1.1 => format!("{:.1} % {verb}", 100.0 * (x - y).abs() / x),
            ratio => format!("{ratio:.1} times {verb}"),
        };
        // A no-break space ties a unit to its number.
        assert!(html.replace('\u{a0}', " ").contains(&by), "no {by}");
    }
    let search = shop.document("found/search.json");
    // The gap is rounded up, so the page never states a smaller gap than the proven gap.
    let gap = number(&search["gap_percent"]);
    let digits = if gap < 0.1 { 1e4 } else { 1e1 };
    let gap = format!("{} %", (gap * digits).ceil() / digits);
    assert!(html.contains(&gap), "no {gap}");
    let drawings: Value = serde_json::from_str(between(&html, "id=\"drawings\">", "</script>")).unwrap();
    assert_eq!(items(&drawings["drawings"]).len(), 2);
    // Every node has a mark with both values.
    let nodes = 5 * 4 + 7 * 2;
    let marks = html.matches(" against ").count();
    assert!(marks >= nodes, "{marks} of {nodes}");
}

#[test]
fn layouts_of_another_question_make_no_page() {
    let shop = shop();
    for (other, said) in [
        ("cells/hitachi_cell.toml", "grid 10 by 8"),
        ("cells/scara_cell.toml", "the reading of the first is signed"),
    ] {
        let ran = shop.run(&["compare", "cells/small.toml", other, "-o", "two.html"]);
        assert_eq!(ran.code, Some(2), "{}", ran.err);
        assert!(ran.err.contains("cannot be compared") && ran.err.contains(said), "{}", ran.err);
        assert!(!shop.path("two.html").exists());
    }
    let ran = shop.run(&["compare", "cells/small.toml", "found", "-o", "cells/small.toml"]);
    assert_eq!(ran.code, Some(2), "{}", ran.err);
    assert_eq!(shop.text("cells/small.toml"), SMALL);
}

#[test]
fn a_page_shows_no_invisible_character_of_a_file_name() {
    let shop = Sandbox::new();
    let file = "cells/soft\u{ad}tag\u{e0041}mark\u{202e}.toml";
    shop.write(file, SMALL);
    shop.done(&["report", file, "--out", "page.html"]);
    let page = shop.text("page.html");
    for hidden in ['\u{ad}', '\u{e0041}', '\u{202e}'] {
        assert!(!page.contains(hidden), "{hidden:?}");
    }
}
