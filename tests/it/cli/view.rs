//! Tests `view` with requests of a browser and of an attacker: addresses, requests, files and a search.

use crate::cli::sandbox::*;
use crate::cli::viewer::{HttpAnswer, Viewer};
use serde_json::{Value, json};
use std::io::Write;
use std::time::Duration;

/// Returns a layout other than the start layout, with numbers that are not round.
fn elsewhere() -> Value {
    json!({ "equipment": {
        "worktable": { "x_mm": 287.3, "y_mm": 1003.7, "z_mm": 612.5, "yaw_deg": 11.3 },
        "conveyor": { "x_mm": 1003.1, "yaw_deg": 78.9 },
    } })
}

/// Cell file with the layout of [`elsewhere`].
const ELSEWHERE: &str = "from = \"hitachi_ideal.toml\"\n[equipment.worktable.placement]\nx_mm = 287.3\n\
     y_mm = 1003.7\nz_mm = 612.5\nyaw_deg = 11.3\n[equipment.conveyor.placement]\nx_mm = 1003.1\ny_mm = -400\n\
     yaw_deg = 78.9\n";

#[test]
fn view_refuses_requests_without_its_secret_host_and_origin() {
    let shop = Sandbox::new();
    let view = Viewer::of(&shop, &[CELL]);
    let Viewer { port, token, .. } = &view;
    let ours = format!("127.0.0.1:{port}");
    let origin = format!("http://{ours}");
    let get = |path: &str, host: &str| {
        view.raw(&format!("GET {path} HTTP/1.1\r\n{host}Connection: close\r\n\r\n")).status
    };
    let host = format!("Host: {ours}\r\n");
    assert_eq!(get(&format!("/{token}/"), &host), 200);
    assert_eq!(get(&format!("/{token}/"), &format!("Host: localhost:{port}\r\n")), 200);
    // Without the right token, every request is refused, even if the rest of the request is right.
    let wrong = token.chars().rev().collect::<String>();
    let short = &token[..31];
    for path in ["/", "/state", "//", &format!("/{wrong}/"), &format!("/{short}/state"), &format!("/{token}")]
    {
        assert_eq!(get(path, &host), 404, "{path}");
    }
    // These hosts belong to foreign pages.
    for host in [
        "Host: evil.example\r\n".into(),
        format!("Host: evil.example:{port}\r\n"),
        "Host: 127.0.0.1\r\n".into(),
        String::new(),
        format!("{host}Host: evil.example\r\n"),
    ] {
        assert_eq!(get(&format!("/{token}/state"), &host), 403, "{host}");
    }
    // Requests that change something must come from the page that `view` serves.
    let post = |host: &str, origin: &str| view.raw(&view.posting("undo", "{}", host, origin)).status;
    assert_eq!(post(&ours, &origin), 200);
    for other in ["null", "http://evil.example", "https://127.0.0.1", &format!("{origin}.evil.example")] {
        assert_eq!(post(&ours, other), 403, "{other}");
    }
    assert_eq!(post("evil.example", &origin), 403);
    let unsaid =
        format!("POST /{token}/undo HTTP/1.1\r\n{host}Content-Length: 2\r\nConnection: close\r\n\r\n{{}}");
    assert_eq!(view.raw(&unsaid).status, 403);
    assert_eq!(view.raw(&unsaid.replace("POST", "PUT")).status, 405);
}

#[test]
fn the_page_of_view_may_load_nothing() {
    let shop = Sandbox::new();
    let view = Viewer::of(&shop, &[CELL]);
    let [one, other] = [view.get(""), view.get("")];
    let nonce = |a: &HttpAnswer| {
        let after = a.head.split_once("'nonce-").unwrap_or_else(|| panic!("{}", a.head)).1.to_string();
        after.split_once('\'').unwrap().0.to_string()
    };
    assert_ne!(nonce(&one), nonce(&other));
    for wanted in [
        "default-src 'none'",
        "connect-src 'self'",
        "frame-ancestors 'none'",
        "nosniff",
        "no-referrer",
        "no-store",
    ] {
        assert!(one.head.contains(wanted), "{wanted}: {}", one.head);
    }
    assert!(!one.head.contains("unsafe"), "{}", one.head);
    // Every script and style has the nonce, and the page fetches nothing from other addresses.
    let marked = format!("nonce=\"{}\"", nonce(&one));
    for tag in ["<script", "<style"] {
        for (at, _) in one.body.match_indices(tag) {
            assert!(one.body[at..].starts_with(&format!("{tag} {marked}")), "{}", &one.body[at..at + 80]);
        }
    }
    assert!(!one.body.contains("src="), "something is fetched");
    // A placeholder of the template is a name in double braces. In a comment of a script, a blank follows the
    // braces.
    let is_placeholder = |(at, _): (usize, &str)| one.body[at + 2..].starts_with(|c: char| c.is_alphabetic());
    assert!(!one.body.match_indices("{{").any(is_placeholder), "a placeholder is left");
}

#[test]
fn the_value_of_a_layout_in_view_agrees_with_map() {
    let shop = Sandbox::new();
    shop.write("cells/elsewhere.toml", ELSEWHERE);
    let view = Viewer::of(&shop, &[IDEAL]);
    let drawn = shop.json(&["map", IDEAL]);
    let now = &view.get("state").json()["now"];
    assert_eq!(now["answer"]["objective"], drawn["objective"]);
    for (question, args) in [
        (json!({ "sense": null, "model": "nonlinear", "reading": "signed" }), vec![]),
        (
            json!({ "sense": "xyz", "model": "linear", "reading": "signed" }),
            vec!["--sense", "xyz", "--model", "linear"],
        ),
        (
            json!({ "sense": "z", "model": "nonlinear", "reading": "worst-case" }),
            vec!["--sense", "z", "--reading", "worst-case"],
        ),
    ] {
        view.done("question", &question);
        let tried = view.done("try", &elsewhere());
        let map = shop.json(&[&["map", "cells/elsewhere.toml"], &args[..]].concat());
        assert_eq!(tried["answer"]["objective"], map["objective"], "{question}");
        assert!(tried["answer"]["objective"].is_number());
        for (mine, theirs) in items(&tried["answer"]["operations"]).iter().zip(items(&map["operations"])) {
            assert_eq!(mine["counts"], theirs["counts"]);
            let best = field(theirs, "best");
            assert_eq!(mine["best"], json!([best["i"], best["j"]]));
            let values = items(&mine["nodes"]["value"]).iter().zip(items(&theirs["nodes"]));
            for (value, node) in values.filter(|(_, node)| node["status"] == "ok") {
                assert!((number(value) - number(&node["value"])).abs() <= 1e-6, "{value} {node}");
            }
        }
    }
    // A trial evaluation changes nothing. Coordinates that the file fixes can also be tried.
    assert_eq!(view.get("state").json()["now"]["undo"], 0);
    shop.write(
        "cells/up.toml",
        "from = \"hitachi_ideal.toml\"\n[equipment.conveyor.placement]\nz_mm = 555\n",
    );
    view.done("question", &json!({ "sense": null, "model": "nonlinear", "reading": "signed" }));
    let up = view.done("try", &json!({ "equipment": { "conveyor": { "z_mm": 555 } } }));
    assert_eq!(up["answer"]["objective"], shop.json(&["map", "cells/up.toml"])["objective"]);
    assert_ne!(up["answer"]["objective"], drawn["objective"]);
}

#[test]
fn view_undoes_redoes_and_restores_a_page() {
    let shop = Sandbox::new();
    let view = Viewer::of(&shop, &[CELL]);
    let objective = |now: &Value| now["answer"]["objective"].clone();
    let start = view.get("state").json()["now"].clone();
    let one = view.done("layout", &json!({ "equipment": { "worktable": { "y_mm": 950 } } }));
    let two = view.done("layout", &elsewhere());
    assert_eq!((&two["undo"], &two["redo"], &two["before"]), (&json!(2), &json!(0), &objective(&one)));
    assert!(text(&one["what"]).contains("worktable y 1000 to 950 mm"), "{}", one["what"]);
    let all = [objective(&start), objective(&one), objective(&two)];
    assert!(all[0] != all[1] && all[1] != all[2]);
    // A reload of the page requests the state from the server.
    let again = view.get("state").json()["now"].clone();
    assert_eq!(again, two);
    let back = view.done("undo", &json!({}));
    assert_eq!((objective(&back), &back["redo"]), (all[1].clone(), &json!(1)));
    view.done("undo", &json!({}));
    let most = view.done("undo", &json!({}));
    assert_eq!(
        (&most["numbers"], objective(&most), &most["undo"]),
        (&start["numbers"], all[0].clone(), &json!(0))
    );
    view.done("redo", &json!({}));
    assert_eq!(view.done("redo", &json!({}))["numbers"], two["numbers"]);
    // A reset can be undone like any other step. A new step discards the undone steps.
    let reset = view.done("reset", &json!({}));
    assert_eq!((objective(&reset), &reset["undo"]), (all[0].clone(), &json!(3)));
    view.done("undo", &json!({}));
    let new = view.done("layout", &json!({ "equipment": { "worktable": { "y_mm": 990 } } }));
    assert_eq!((&new["undo"], &new["redo"]), (&json!(3), &json!(0)));
}

#[test]
fn view_refuses_invalid_requests_with_a_message() {
    let shop = Sandbox::new();
    let view = Viewer::of(&shop, &[CELL]);
    let worktable = |number: &str| format!("{{\"equipment\":{{\"worktable\":{{\"x_mm\":{number}}}}}}}");
    for what in ["try", "layout"] {
        for (body, word) in [
            (worktable("NaN"), "not JSON"),
            (worktable("1e999"), "not JSON"),
            (worktable("null"), "must be a number"),
            (worktable("\"5\""), "must be a number"),
            (worktable("1800.01"), "must be from -1800 to 1800"),
            (worktable("-1e9"), "must be from -1800 to 1800"),
            ("{\"equipment\":{\"nobody\":{\"x_mm\":1}}}".into(), "no equipment `nobody`"),
            ("{\"equipment\":{\"post\":{\"x_mm\":1}}}".into(), "obstacle"),
            ("{\"equipment\":{\"worktable\":{\"q_mm\":1}}}".into(), "no coordinate `q_mm`"),
            ("{\"attitude\":{\"assembly\":{\"bend_deg\":1}}}".into(), "no coordinate `bend_deg`"),
            ("{\"robot_base\":{\"x_mm\":1e8}}".into(), "must be from"),
            ("{\"equipment\":[1]}".into(), "must be an object"),
            ("{\"robots\":{\"x\":{}}}".into(), "not one of"),
            ("[]".into(), "must be an object"),
            ("{".into(), "not JSON"),
            ("".into(), "not JSON"),
            ("[".repeat(60_000), "not JSON"),
        ] {
            let said = view.refused(what, &body);
            assert!(said.contains(word), "{body:.80}: {said}");
        }
    }
    let large = format!("{{\"x\":\"{}\"}}", "y".repeat(70_000));
    let refused = view.post("layout", &large);
    assert_eq!(refused.status, 413, "{}", refused.body);
    assert!(text(&refused.json()["error"]).contains("more than"), "{}", refused.body);
    for body in [
        "{}",
        "{\"model\":\"nonlinear\"}",
        "{\"model\":\"nonlinear\",\"reading\":\"signed\",\"sense\":\"q\"}",
    ] {
        view.refused("question", body);
    }
    for body in ["{\"budget\":0}", "{\"budget\":1.5}", "{\"seed\":-1}", "{\"budget\":\"9\"}"] {
        view.refused("search", body);
    }
    view.refused("accept", "{}");
    let Viewer { port, token, .. } = &view;
    // A request without a length or with a missing body gets an answer, and no other request waits for it.
    let head = format!(
        "POST /{token}/layout HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nOrigin: http://127.0.0.1:{port}\r\n"
    );
    assert_eq!(view.raw(&format!("{head}Connection: close\r\n\r\n")).status, 400);
    let mut slow = view.stream();
    slow.write_all(format!("{head}Content-Length: 5000\r\n\r\n{{").as_bytes()).unwrap();
    assert_eq!(view.raw(&format!("{head}Content-Length: 9000000000\r\n\r\n{{")).status, 413);
    assert_eq!(view.get("state").status, 200);
    // After all these requests, the layout is still the start layout.
    assert_eq!(view.get("state").json()["now"]["undo"], 0);
}

#[test]
fn a_saved_layout_is_a_loadable_cell() {
    let shop = Sandbox::new();
    let view = Viewer::of(&shop, &[CELL]);
    view.done("layout", &elsewhere());
    // The saved file also contains coordinates that the cell file fixes.
    view.done(
        "layout",
        &json!({ "equipment": { "conveyor": { "z_mm": 590.25 } }, "robot_base": { "z_mm": 1.5 } }),
    );
    let now =
        view.done("question", &json!({ "sense": "xyz", "model": "second-order", "reading": "worst-case" }));
    let saved = view.done("save", &json!({ "name": "by_hand" }));
    assert_eq!(saved["saved"], "cells/by_hand.toml");
    shop.done(&["check", "cells/by_hand.toml"]);
    let map = shop.json(&["map", "cells/by_hand.toml"]);
    assert_eq!(map["objective"], now["answer"]["objective"]);
    assert!(map["objective"].is_number());
    assert_eq!(map["operations"][0]["sense"], "xyz");
    // Another existing file is replaced only on a second request. The source file of the layout is never
    // replaced.
    let before = shop.read("cells/by_hand.toml");
    view.done("undo", &json!({}));
    let taken = view.post("save", "{\"name\":\"by_hand.toml\"}");
    assert_eq!((taken.status, &taken.json()["taken"]), (409, &json!(true)));
    assert_eq!(shop.read("cells/by_hand.toml"), before);
    view.done("save", &json!({ "name": "by_hand", "overwrite": true }));
    assert_ne!(shop.read("cells/by_hand.toml"), before);
    let own = shop.read(CELL);
    let said = view.refused("save", "{\"name\":\"hitachi_cell\",\"overwrite\":true}");
    assert!(said.contains("made from"), "{said}");
    assert_eq!(shop.read(CELL), own);
}

#[test]
fn a_save_name_cannot_leave_the_folder() {
    let shop = Sandbox::new();
    let view = Viewer::of(&shop, &[CELL]);
    let before = shop.files("");
    for name in [
        "",
        " ",
        ".toml",
        "..",
        "../x",
        "..\\x",
        "/x",
        "/x.toml",
        "a/b",
        "a\\b",
        "C:\\x",
        "c:x",
        "CON",
        "con.toml",
        "nul.x",
        "COM1",
        "lpt9.toml",
        "aux ",
        ".hidden",
        "-rf",
        "x\u{0}y",
        "x\ny",
        "\u{202e}x",
        "x:stream",
        "~",
        "*",
        "$x",
        &"n".repeat(200),
    ] {
        let body = json!({ "name": name, "overwrite": true }).to_string();
        view.refused("save", &body);
    }
    view.refused("save", "{\"name\":5}");
    view.refused("save", "{}");
    assert_eq!(shop.files(""), before);
}

#[test]
fn a_search_in_view_equals_the_search_command() {
    let shop = Sandbox::new();
    let view = Viewer::of(&shop, &[CELL]);
    let now = view.done("layout", &elsewhere());
    let began = view.done("search", &json!({ "budget": 600, "seed": 7 }));
    assert_eq!(began["search"]["budget"], 600);
    let search = ended(&view);
    assert!((number(&search["start"]) - number(&now["answer"]["objective"])).abs() < 1e-9, "{search}");
    // A search of a file with this start layout gives the same result.
    let range = |min: f64, max: f64, start: f64| format!("{{ min = {min}, max = {max}, start = {start} }}");
    let from = format!(
        "from = \"hitachi_cell.toml\"\n[equipment.worktable.placement]\nx_mm = {}\ny_mm = {}\nz_mm = {}\nyaw_deg = {}\n\
         [equipment.conveyor.placement]\nx_mm = {}\nyaw_deg = {}\n",
        range(-1800.0, 1800.0, 287.3),
        range(-1800.0, 1800.0, 1003.7),
        range(300.0, 900.0, 612.5),
        range(-90.0, 90.0, 11.3),
        range(-2000.0, 2000.0, 1003.1),
        range(-90.0, 90.0, 78.9),
    );
    shop.write("cells/from_here.toml", &from);
    let args = ["search", "cells/from_here.toml", "--budget", "600", "--seed", "7", "--out", "found"];
    let found = shop.json(&args);
    let best = number(&found["objective_mm"]);
    assert!((number(&search["best"]) - best).abs() < 1e-9, "{search} {best}");
    assert!(number(&search["gain_percent"]) > 0.0, "{search}");
    // Accepting the layout of the search is a step that can be undone.
    let accepted = view.done("accept", &json!({}));
    assert!((number(&accepted["answer"]["objective"]) - best).abs() < 1e-9);
    assert_eq!(accepted["numbers"]["equipment"]["worktable"], found["layout"]["worktable"]);
    assert_eq!(view.done("undo", &json!({}))["numbers"], now["numbers"]);
}

/// Waits for the end of the search and returns its state.
fn ended(view: &Viewer) -> Value {
    for _ in 0..2400 {
        let search = view.get("pulse").json()["search"].clone();
        if search["running"] == false {
            return search;
        }
        std::thread::sleep(Duration::from_millis(50));
    }
    panic!("the search does not end");
}

#[test]
fn the_page_answers_during_a_search_and_can_stop_it() {
    let shop = Sandbox::new();
    let view = Viewer::of(&shop, &[CELL]);
    view.done("search", &json!({ "budget": 100_000_000, "seed": 1 }));
    assert!(view.refused("search", "{\"budget\":5}").contains("already running"));
    let tried = view.done("try", &elsewhere());
    assert!(tried["answer"]["objective"].is_number());
    view.refused("accept", "{}");
    view.done("stop", &json!({}));
    let search = ended(&view);
    assert!(text(&search["ended"]).contains("interrupted"), "{search}");
    assert!(number(&search["evaluations"]) < 1e8);
}

#[test]
fn view_offers_a_search_from_a_result() {
    let shop = Sandbox::new();
    shop.done(&["search", CELL, "--budget", "300", "--out", "found"]);
    let view = Viewer::of(&shop, &["found"]);
    let state = view.get("state").json();
    assert_eq!(state["can_search"], true);
    assert_eq!(state["now"]["answer"]["objective"], shop.json(&["map", "found/best.toml"])["objective"]);
    let x = &items(&state["form"])[0]["numbers"][0];
    assert_eq!((&x["min"], &x["max"], &x["free"]), (&json!(-1800.0), &json!(1800.0), &json!(true)));
    view.done("layout", &json!({ "equipment": { "worktable": { "x_mm": 200 } } }));
    assert_eq!(view.done("save", &json!({ "name": "other" }))["saved"], "found/other.toml");
    let now = view.get("state").json()["now"]["answer"]["objective"].clone();
    assert_eq!(shop.json(&["map", "found/other.toml"])["objective"], now);
}

#[test]
fn view_ends_at_once_on_a_taken_port_or_a_bad_cell() {
    let shop = Sandbox::new();
    let view = Viewer::of(&shop, &[CELL]);
    let ran = shop.run(&["view", CELL, "--port", &view.port.to_string()]);
    assert_eq!((ran.code, ran.out.as_str()), (Some(3), ""), "{}", ran.err);
    assert_eq!(shop.run(&["view", "cells/nothing.toml"]).code, Some(3));
    shop.write("cells/bad.toml", "schema = 5\n");
    assert_eq!(shop.run(&["view", "cells/bad.toml"]).code, Some(2));
}

/// Ctrl-C is the normal end of `view`, so it exits 0.
#[cfg(unix)]
#[test]
fn view_exits_0_on_a_signal() {
    let shop = Sandbox::new();
    let mut view = Viewer::of(&shop, &[CELL]);
    view.done("search", &json!({ "budget": 100_000_000 }));
    let kill = std::process::Command::new("kill").args(["-INT", &view.child.id().to_string()]).status();
    assert!(kill.unwrap().success());
    assert_eq!(view.child.wait().unwrap().code(), Some(0));
}
