//! Tests of manual pages, of the reference of all commands, and of completions.

use super::sandbox::Sandbox;

/// Returns the names of all commands, from the help.
fn commands(shop: &Sandbox) -> Vec<String> {
    let help = shop.done(&["--help"]).out;
    let list = help.split("Commands:\n").nth(1).unwrap().split("\n\n").next().unwrap();
    let names = list.lines().filter(|line| line.starts_with("  ") && !line.starts_with("   "));
    names.map(|line| line.split_whitespace().next().unwrap().to_string()).collect()
}

/// Returns the long options of a command, from its help.
fn options(shop: &Sandbox, command: &str) -> Vec<String> {
    let help = shop.done(&[command, "--help"]).out;
    let lines = help.lines().filter(|line| line.trim_start().starts_with('-'));
    let option = |line: &str| {
        let word = line.split([' ', ',']).find(|word| word.starts_with("--"))?;
        Some(word.to_string())
    };
    lines.filter_map(option).collect()
}

#[test]
fn every_command_has_a_manual_page_with_its_options_and_the_exit_codes() {
    let shop = Sandbox::new();
    let ran = shop.done(&["man", "--out", "pages/man1"]);
    let commands = commands(&shop);
    assert!(ran.out.is_empty() && ran.err.contains(&format!("wrote {} manual pages", commands.len() + 1)));
    assert_eq!(shop.files("pages/man1").len(), commands.len() + 1);
    assert_eq!(shop.done(&["man"]).out, shop.text("pages/man1/sweetspot.1"));
    let mut count = 0;
    for command in &commands {
        let page = shop.text(&format!("pages/man1/sweetspot-{command}.1"));
        assert_eq!(shop.done(&["man", command]).out, page);
        assert!(page.contains(&format!(".TH sweetspot-{command} 1")), "{page}");
        for part in ["\n.SH NAME", "\n.SH SYNOPSIS", "\n.SH EXAMPLE", "\n.SH \"EXIT STATUS\"", "\\fB130\\fR"]
        {
            assert!(page.contains(part), "{command}: no {part}: {page}");
        }
        for option in options(&shop, command) {
            assert!(page.contains(&option.replace('-', "\\-")), "{command}: no {option}");
            count += 1;
        }
    }
    assert!(count > 150, "{count} options");
}

#[test]
fn the_reference_of_commands_has_every_command_option_and_value() {
    let shop = Sandbox::new();
    let text = shop.done(&["man", "--markdown"]).out;
    for command in commands(&shop) {
        let section =
            text.split(&format!("\n## sweetspot {command}\n")).nth(1).unwrap_or_else(|| panic!("{command}"));
        let section = section.split("\n## ").next().unwrap();
        for option in options(&shop, &command).iter().filter(|option| *option != "--help") {
            assert!(
                section.lines().any(|line| line.starts_with("| `") && line.contains(option.as_str())),
                "{option}"
            );
        }
    }
    assert!(text.contains("Values: `nonlinear`, `linear`, `second-order`."));
    assert!(text.contains("Default: `60`.") && text.contains("| 130 | "), "{text}");
    let columns = |line: &str| line.replace("\\|", "").matches('|').count();
    assert!(text.lines().filter(|line| line.starts_with("| ")).all(|line| columns(line) == 3));
}

#[test]
fn completions_name_every_command() {
    let shop = Sandbox::new();
    for shell in ["bash", "zsh", "fish", "powershell", "elvish"] {
        let text = shop.done(&["completions", shell]).out;
        for command in commands(&shop) {
            assert!(text.contains(&command), "{shell}: {command}");
        }
        assert!(text.contains("registration"), "{shell}");
    }
}

#[test]
fn bad_usage_of_the_manual_is_refused() {
    let shop = Sandbox::new();
    let ran = shop.run(&["man", "serch"]);
    assert_eq!((ran.code, ran.out.as_str()), (Some(2), ""));
    assert!(ran.err.contains("did you mean search?"), "{}", ran.err);
    for args in [&["completions"][..], &["completions", "tcsh"], &["man", "--out", "x", "--markdown"]] {
        assert_eq!(shop.run(args).code, Some(2), "{args:?}");
    }
    shop.write("file", "");
    assert_eq!(shop.run(&["man", "--out", "file/pages"]).code, Some(3));
}
