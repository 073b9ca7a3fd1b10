mod common;
use common::{load_from, root};
fn told(name: &str) -> Vec<String> {
    let faults = match load_from(&root().join("tests/broken"), name) { Ok(l) => l.warnings, Err(f) => f };
    faults.iter().flat_map(|f| { let s = f.to_string(); s.lines().enumerate().filter(|(i,l)| *i==0 || l.starts_with("  help: ")).map(|(_,l)| l.to_string()).collect::<Vec<_>>() }).collect()
}
#[test]
fn fill() {
    let only = std::env::var("FILL").unwrap();
    for name in only.split_whitespace() {
        let path = root().join("tests/broken").join(name);
        let text = std::fs::read_to_string(&path).unwrap();
        let body: String = text.lines().skip_while(|l| l.starts_with("#! ")).map(|l| format!("{l}\n")).collect();
        std::fs::write(&path, &body).unwrap();
        let n = told(name).len();
        std::fs::write(&path, "#\n".repeat(n) + &body).unwrap();
        let head: String = told(name).iter().map(|l| format!("#! {l}\n")).collect();
        println!("== {name}\n{head}");
        std::fs::write(&path, head + &body).unwrap();
    }
}
