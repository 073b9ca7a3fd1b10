//! Process of `view`, and requests to it as bytes on a socket.

use crate::cli::sandbox::*;
use serde_json::Value;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::PathBuf;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

/// Process of `view` that ends with the test.
pub struct Viewer {
    pub child: Child,
    pub port: u16,
    pub token: String,
    talk: PathBuf,
}

impl Drop for Viewer {
    fn drop(&mut self) {
        let _ = self.child.kill();
        let _ = self.child.wait();
        let talk = std::fs::read_to_string(&self.talk).unwrap_or_default();
        assert!(std::thread::panicking() || !talk.contains("panicked"), "{talk}");
    }
}

/// Answer to a request.
pub struct HttpAnswer {
    pub status: u16,
    pub head: String,
    pub body: String,
}

impl HttpAnswer {
    pub fn json(&self) -> Value {
        serde_json::from_str(&self.body).unwrap_or_else(|e| panic!("{e}: {}", self.body))
    }
}

impl Viewer {
    pub fn of(shop: &Sandbox, args: &[&str]) -> Self {
        Self::by(shop, shop.command(&[&["view"], args].concat()))
    }

    /// Starts `view` with a given command.
    pub fn by(shop: &Sandbox, mut command: Command) -> Self {
        let talk = shop.path(".talk");
        let said = std::fs::File::create(&talk).unwrap();
        let mut child = command.stdout(Stdio::piped()).stderr(said).spawn().unwrap();
        let mut line = String::new();
        BufReader::new(child.stdout.take().unwrap()).read_line(&mut line).unwrap();
        let inside = line.trim().strip_prefix("http://127.0.0.1:").unwrap_or_else(|| panic!("{line}"));
        let (port, token) = inside.split_once('/').unwrap();
        let token = token.strip_suffix('/').unwrap().to_string();
        assert!(token.len() == 32 && token.bytes().all(|b| b.is_ascii_hexdigit()), "{token}");
        Self { child, port: port.parse().unwrap(), token, talk }
    }

    /// Returns what the program wrote to stderr so far.
    pub fn talk(&self) -> String {
        std::fs::read_to_string(&self.talk).unwrap()
    }

    pub fn stream(&self) -> TcpStream {
        let stream = TcpStream::connect(("127.0.0.1", self.port)).unwrap();
        // If the server hangs, the test fails instead of waiting.
        stream.set_read_timeout(Some(Duration::from_secs(120))).unwrap();
        stream
    }

    /// Sends bytes unchanged and returns the answer.
    pub fn raw(&self, bytes: &str) -> HttpAnswer {
        let mut stream = self.stream();
        stream.write_all(bytes.as_bytes()).unwrap();
        answered(&mut stream)
    }

    pub fn get(&self, what: &str) -> HttpAnswer {
        let Self { port, token, .. } = self;
        self.raw(&format!(
            "GET /{token}/{what} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nConnection: close\r\n\r\n"
        ))
    }

    pub fn post(&self, what: &str, body: &str) -> HttpAnswer {
        let origin = format!("http://127.0.0.1:{}", self.port);
        self.raw(&self.posting(what, body, &format!("127.0.0.1:{}", self.port), &origin))
    }

    pub fn posting(&self, what: &str, body: &str, host: &str, origin: &str) -> String {
        format!(
            "POST /{}/{what} HTTP/1.1\r\nHost: {host}\r\nOrigin: {origin}\r\nContent-Length: {}\r\n\
             Connection: close\r\n\r\n{body}",
            self.token,
            body.len()
        )
    }

    /// Sends a POST request and asserts success.
    pub fn done(&self, what: &str, body: &Value) -> Value {
        let answered = self.post(what, &body.to_string());
        assert_eq!(answered.status, 200, "{what}: {}", answered.body);
        answered.json()
    }

    /// Sends a POST request, asserts that it is refused, and returns the message for the page.
    pub fn refused(&self, what: &str, body: &str) -> String {
        let answered = self.post(what, body);
        assert_eq!(answered.status, 400, "{what} {body}: {}", answered.body);
        text(&answered.json()["error"]).to_string()
    }
}

/// Reads one answer.
pub fn answered(stream: &mut TcpStream) -> HttpAnswer {
    let mut reader = BufReader::new(stream);
    let (mut head, mut length) = (String::new(), None);
    loop {
        let mut line = String::new();
        reader.read_line(&mut line).unwrap();
        if let Some(value) = line.to_ascii_lowercase().strip_prefix("content-length:") {
            length = Some(value.trim().parse::<usize>().unwrap());
        }
        if line.trim().is_empty() {
            break;
        }
        head += &line;
    }
    let mut body = vec![0; length.unwrap_or_else(|| panic!("no length: {head}"))];
    reader.read_exact(&mut body).unwrap();
    let status = head.split(' ').nth(1).unwrap_or_else(|| panic!("{head}")).parse().unwrap();
    HttpAnswer { status, head, body: String::from_utf8(body).unwrap() }
}
