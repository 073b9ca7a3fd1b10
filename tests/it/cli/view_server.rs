//! Tests the server of `view` against clients that exhaust connections, headers, bodies or time, and against
//! other users who read the process list.

use crate::cli::sandbox::*;
use crate::cli::viewer::{Viewer, answered};
use serde_json::{Value, json};
use std::io::{Read, Write};
use std::net::TcpStream;
use std::time::{Duration, Instant};

/// Waits until a condition holds. Fails if it takes too long.
#[cfg(target_os = "linux")]
fn wait_until(what: &str, holds: impl Fn() -> bool) {
    let began = Instant::now();
    while !holds() {
        assert!(began.elapsed() < Duration::from_secs(60), "{what} does not happen");
        std::thread::sleep(Duration::from_millis(20));
    }
}

/// Returns the header of a POST request without its length and its end.
fn posting(view: &Viewer, what: &str) -> String {
    let Viewer { port, token, .. } = view;
    format!("POST /{token}/{what} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nOrigin: http://127.0.0.1:{port}\r\n")
}

/// Returns the number of steps that can be undone. This number shows whether a request belongs to the
/// session.
fn undo(view: &Viewer) -> Value {
    view.get("now").json()["undo"].clone()
}

/// Returns a move of the worktable within its range.
fn moved() -> Value {
    json!({ "equipment": { "worktable": { "x_mm": 287.3 } } })
}

/// The shell limits the number of files that the program may open.
#[cfg(target_os = "linux")]
#[test]
fn view_and_its_session_outlast_more_connections_than_open_files() {
    let shop = Sandbox::new();
    let program = shop.command(&["view", CELL]);
    let mut limited = std::process::Command::new("sh");
    limited.args(["-c", "ulimit -n 32 && exec \"$0\" view \"$1\""]).arg(program.get_program()).arg(CELL);
    limited.env("SWEETSPOT_CACHE", "off").current_dir(shop.dir.path());
    let view = Viewer::by(&shop, limited);
    view.done("layout", &moved());
    let strangers: Vec<TcpStream> = (0..60).map(|_| view.stream()).collect();
    let failure = "could not be accepted";
    wait_until("a failure to accept", || view.talk().contains(failure));
    // The program runs out of files during many attempts.
    std::thread::sleep(Duration::from_secs(1));
    drop(strangers);
    assert_eq!(undo(&view), json!(1));
    assert_eq!(view.talk().matches(failure).count(), 1, "{}", view.talk());
    assert!(view.talk().contains("Too many open files"), "{}", view.talk());
}

/// Returns the number of open files of a program, as the operating system counts them.
#[cfg(target_os = "linux")]
fn open_files(view: &Viewer) -> usize {
    std::fs::read_dir(format!("/proc/{}/fd", view.child.id())).unwrap().count()
}

#[cfg(target_os = "linux")]
#[test]
fn view_opens_at_most_64_connections() {
    let shop = Sandbox::new();
    let view = Viewer::of(&shop, &[CELL]);
    let before = open_files(&view);
    let strangers: Vec<TcpStream> = (0..150).map(|_| view.stream()).collect();
    wait_until("the last connection", || open_files(&view) >= before + 64);
    for _ in 0..50 {
        let files = open_files(&view);
        assert!(files <= before + 64, "{files} files, {before} of them without connections");
        std::thread::sleep(Duration::from_millis(20));
    }
    drop(strangers);
    assert_eq!(view.get("state").status, 200);
    wait_until("the end of all connections", || open_files(&view) <= before);
}

/// Returns the largest memory that a program has used so far, kB.
#[cfg(target_os = "linux")]
fn peak_memory(view: &Viewer) -> u64 {
    let status = std::fs::read_to_string(format!("/proc/{}/status", view.child.id())).unwrap();
    let line = status.lines().find_map(|l| l.strip_prefix("VmHWM:")).unwrap();
    line.trim().strip_suffix(" kB").unwrap().parse().unwrap()
}

#[cfg(target_os = "linux")]
#[test]
fn a_head_without_end_costs_view_no_memory() {
    let shop = Sandbox::new();
    let view = Viewer::of(&shop, &[CELL]);
    let before = peak_memory(&view);
    let chunk = [b'a'; 1 << 16];
    for start in ["GET /", "GET / HTTP/1.1\r\nX-Long: ", "POST / HTTP/1.1\r\nHost: "] {
        let mut stream = view.stream();
        stream.write_all(start.as_bytes()).unwrap();
        let mut sent = 0;
        while sent < 64 << 20 && stream.write_all(&chunk).is_ok() {
            sent += chunk.len();
        }
        assert!(sent < 64 << 20, "{start}: the server takes it all");
    }
    let grown = peak_memory(&view) - before;
    assert!(grown < 8 << 10, "{grown} kB");
    // A short request can still have too many headers.
    let many = format!("GET / HTTP/1.1\r\n{}\r\n", "X: 1\r\n".repeat(200));
    assert_eq!(view.raw(&many).status, 431);
    assert_eq!(view.get("state").status, 200);
}

/// Reads until the server closes the connection. Returns the received bytes and the time until the end.
fn closed(mut stream: TcpStream) -> (Vec<u8>, Duration) {
    let (began, mut bytes) = (Instant::now(), Vec::new());
    // A connection that the server resets also counts as closed.
    match stream.read_to_end(&mut bytes) {
        Err(e) if e.kind() != std::io::ErrorKind::ConnectionReset => panic!("not closed: {e}"),
        _ => (bytes, began.elapsed()),
    }
}

#[test]
fn view_closes_connections_that_take_too_long() {
    let shop = Sandbox::new();
    let view = Viewer::of(&shop, &[CELL]);
    let Viewer { port, token, .. } = &view;
    let sending = |bytes: &str| {
        let mut stream = view.stream();
        stream.write_all(bytes.as_bytes()).unwrap();
        stream
    };
    let silent = sending("");
    let half_head = sending("GET / HTTP/1.1\r\nHost: ");
    let half_body = sending(&format!("{}Content-Length: 5000\r\n\r\n{{", posting(&view, "layout")));
    // This client requests the page so often that every buffer is full, but reads nothing.
    let ask = format!("GET /{token}/ HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n");
    let page = view.get("").body.len();
    let (mut greedy, began) = (sending(&ask.repeat(100)), Instant::now());
    // One connection handles several requests and is then idle.
    let mut idle = sending(&ask);
    assert_eq!(answered(&mut idle).body.len(), page);
    idle.write_all(ask.as_bytes()).unwrap();
    assert_eq!(answered(&mut idle).status, 200);
    for (name, stream, seconds) in [
        ("silent", silent, 5),
        ("half a head", half_head, 5),
        ("idle", idle, 5),
        ("half a body", half_body, 10),
    ] {
        let (bytes, took) = closed(stream);
        assert!(took < Duration::from_secs(seconds + 10), "{name}: {took:?}");
        let said = String::from_utf8(bytes).unwrap();
        assert!(said.is_empty() || said.starts_with("HTTP/1.1 408"), "{name}: {said}");
        assert_eq!(said.is_empty(), name != "half a body", "{name}: {said}");
    }
    // The buffers are full after some seconds. The server then waits 10 s for the client. Nothing can be sent
    // through a closed connection.
    while began.elapsed() < Duration::from_secs(20) && greedy.write_all(b" ").is_ok() {
        std::thread::sleep(Duration::from_millis(200));
    }
    let (bytes, _) = closed(greedy);
    assert!(bytes.len() < 100 * page, "{} of {page} bytes a page", bytes.len());
    assert_eq!(undo(&view), json!(0));
}

#[test]
fn view_refuses_a_stranger_before_the_body_arrives() {
    let shop = Sandbox::new();
    let view = Viewer::of(&shop, &[CELL]);
    let right = posting(&view, "layout");
    let reversed: String = view.token.chars().rev().collect();
    for (head, status) in [
        (right.replace(&view.token, &reversed), 404),
        (right.replace("Host: ", "Host: evil."), 403),
        (right.replace("Origin: http://", "Origin: http://evil."), 403),
    ] {
        let began = Instant::now();
        assert_eq!(view.raw(&format!("{head}Content-Length: 5000\r\n\r\n")).status, status);
        // A body has 10 s to arrive.
        assert!(began.elapsed() < Duration::from_secs(8), "{:?}", began.elapsed());
    }
}

/// A chunked body does not state its length.
#[test]
fn view_bounds_a_body_of_unknown_length() {
    let shop = Sandbox::new();
    let view = Viewer::of(&shop, &[CELL]);
    let head = format!("{}Transfer-Encoding: chunked\r\nConnection: close\r\n\r\n", posting(&view, "layout"));
    let body = moved().to_string();
    assert_eq!(view.raw(&format!("{head}{:x}\r\n{body}\r\n0\r\n\r\n", body.len())).status, 200);
    let chunk = format!("1000\r\n{}\r\n", " ".repeat(0x1000));
    assert_eq!(view.raw(&format!("{head}{}0\r\n\r\n", chunk.repeat(17))).status, 413);
    assert_eq!(undo(&view), json!(1));
}

#[test]
fn view_does_nothing_on_a_body_that_does_not_fit_its_type() {
    let shop = Sandbox::new();
    let view = Viewer::of(&shop, &[CELL]);
    let before = shop.files("");
    let empty = ["undo", "redo", "reset", "accept", "stop"];
    let others = ["search", "question", "save", "layout", "try", "try-drawing"];
    for what in empty.iter().chain(&others) {
        for body in ["null", "[]", "[1]", "[null,null]", "5", "\"x\"", "true", "", "{} {}"] {
            view.refused(what, body);
        }
        let said = view.refused(what, "{\"colour\":\"red\"}");
        assert!(said.contains("colour"), "{what}: {said}");
    }
    let question = |key: &str, value: &str| {
        let mut fields = json!({ "sense": null, "model": "nonlinear", "reading": "signed" });
        fields[key] = serde_json::from_str(value).unwrap();
        fields.to_string()
    };
    for (what, key, body) in [
        ("search", "budget", "{\"budget\":\"9\"}".to_string()),
        ("search", "budget", "{\"budget\":1.5}".into()),
        ("search", "seed", "{\"budget\":600,\"seed\":-1}".into()),
        ("search", "budgets", "{\"budgets\":600}".into()),
        ("question", "sense", question("sense", "5")),
        ("question", "model", question("model", "null")),
        ("question", "reading", question("reading", "[]")),
        ("question", "more", question("more", "1")),
        ("save", "name", "{\"overwrite\":true}".into()),
        ("save", "name", "{\"name\":null}".into()),
        ("save", "overwrite", "{\"name\":\"x\",\"overwrite\":\"true\"}".into()),
        ("save", "path", "{\"name\":\"x\",\"path\":\"/tmp\"}".into()),
    ] {
        let said = view.refused(what, &body);
        assert!(said.contains(&format!("`{key}`")), "{what} {body}: {said}");
    }
    assert_eq!(view.get("pulse").json()["search"], Value::Null);
    assert_eq!(undo(&view), json!(0));
    assert_eq!(shop.files(""), before);
}

/// The test replaces `xdg-open` by a script that records its arguments.
#[cfg(target_os = "linux")]
#[test]
fn view_hands_the_browser_no_secret_on_its_command_line() {
    use std::os::unix::fs::PermissionsExt;
    let shop = Sandbox::new();
    std::fs::create_dir(shop.path("bin")).unwrap();
    std::fs::create_dir(shop.path("temporary")).unwrap();
    // Every user can see the command line of a process. The script records it, and copies the file that the
    // browser would open.
    let script = "#!/bin/sh\nstat -c %a \"$1\" > mode\ncp \"$1\" page\n\
                  tr '\\0' '\\n' < /proc/$$/cmdline > copy\nmv copy words\n";
    shop.write("bin/xdg-open", script);
    let mode = std::fs::Permissions::from_mode(0o755);
    std::fs::set_permissions(shop.path("bin/xdg-open"), mode).unwrap();
    let mut command = shop.command(&["view", CELL, "--open"]);
    let path = format!("{}:{}", shop.path("bin").display(), std::env::var("PATH").unwrap());
    command.env("PATH", path).env("TMPDIR", shop.path("temporary"));
    let mut view = Viewer::by(&shop, command);
    wait_until("a browser", || shop.path("words").exists());
    let words = shop.text("words");
    assert!(words.contains("xdg-open") && !words.contains(&view.token), "{words}");
    let file = words.lines().last().unwrap();
    assert!(file.ends_with(".html"), "{words}");
    let address = format!("http://127.0.0.1:{}/{}/", view.port, view.token);
    assert!(shop.text("page").contains(&format!("url={address}\"")), "{}", shop.text("page"));
    assert_eq!(shop.text("mode"), "600\n");
    // The file is removed at the end of the session.
    assert_eq!(shop.files("temporary").len(), 1);
    let kill = std::process::Command::new("kill").args(["-INT", &view.child.id().to_string()]).status();
    assert!(kill.unwrap().success());
    assert_eq!(view.child.wait().unwrap().code(), Some(0));
    assert!(shop.files("temporary").is_empty(), "{:?}", shop.files("temporary"));
}
