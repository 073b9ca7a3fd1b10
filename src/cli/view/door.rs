//! Who may come in: this machine's own page, and nobody else who can make a browser ask.
//!
//! The address holds 128 random bits; without them there is nothing (404). The name that the browser asked
//! for must be ours (a foreign name that resolves to 127.0.0.1 is somebody's page), and what changes
//! something must come from our own page.

use std::io::Read;
use tiny_http::{Header, Method, Request};

/// Largest body, bytes: a request of the page has some hundred.
const MOST_BYTES: usize = 64 << 10;

/// The address of the page.
pub struct Door {
    token: String,
    port: u16,
}

/// What is answered to a request.
pub struct Answer {
    pub status: u16,
    pub kind: &'static str,
    pub body: Vec<u8>,
    /// Of the page itself: what its scripts and styles are marked with.
    pub nonce: Option<String>,
}

impl Answer {
    pub fn refused(status: u16, why: &str) -> Self {
        Self::json(status, &serde_json::json!({ "error": why }))
    }

    pub fn json(status: u16, value: &serde_json::Value) -> Self {
        let body = value.to_string().into_bytes();
        Self { status, kind: "application/json", body, nonce: None }
    }
}

/// 128 random bits of the operating system in hexadecimal.
///
/// # Errors
/// That there are none.
pub fn secret() -> Result<String, String> {
    let mut bytes = [0u8; 16];
    getrandom::fill(&mut bytes).map_err(|e| format!("the system has no random numbers: {e}"))?;
    Ok(bytes.iter().map(|b| format!("{b:02x}")).collect())
}

impl Door {
    pub fn new(token: String, port: u16) -> Self {
        Self { token, port }
    }

    pub fn url(&self) -> String {
        format!("http://127.0.0.1:{}/{}/", self.port, self.token)
    }

    /// What is asked for inside, if the request may come in.
    ///
    /// # Errors
    /// The answer to one that may not.
    pub fn admit(&self, request: &Request) -> Result<String, Answer> {
        let inside = request.url().strip_prefix('/').and_then(|path| path.split_once('/'));
        let inside = inside.filter(|(token, _)| same(token, &self.token)).map(|(_, inside)| inside);
        let Some(inside) = inside else { return Err(Answer::refused(404, "there is nothing here")) };
        let hosts = ["127.0.0.1", "localhost"].map(|name| format!("{name}:{}", self.port));
        match &header(request, "Host")[..] {
            [host] if hosts.contains(&host.to_ascii_lowercase()) => {}
            _ => return Err(Answer::refused(403, "this is not the address of the page")),
        }
        match request.method() {
            Method::Get => {}
            Method::Post => {
                let origins = hosts.map(|host| format!("http://{host}"));
                match &header(request, "Origin")[..] {
                    [origin] if origins.contains(&origin.to_ascii_lowercase()) => {}
                    _ => return Err(Answer::refused(403, "that does not come from the page")),
                }
            }
            _ => return Err(Answer::refused(405, "ask with GET or POST")),
        }
        Ok(inside.to_string())
    }
}

/// The body of a request, read whole.
///
/// # Errors
/// The answer to one that has none, or too much of it.
pub fn body(request: &mut Request) -> Result<Vec<u8>, Answer> {
    let length = request.body_length().filter(|_| header(request, "Transfer-Encoding").is_empty());
    let length = length.ok_or_else(|| Answer::refused(400, "the request does not say how long it is"))?;
    if length > MOST_BYTES {
        return Err(Answer::refused(400, &format!("the request has more than {MOST_BYTES} bytes")));
    }
    let mut bytes = Vec::with_capacity(length);
    let read = request.as_reader().take(length as u64).read_to_end(&mut bytes);
    match read {
        Ok(count) if count == length => Ok(bytes),
        _ => Err(Answer::refused(400, "the request ended early")),
    }
}

fn header<'r>(request: &'r Request, name: &'static str) -> Vec<&'r str> {
    let of_name = |h: &&Header| h.field.equiv(name);
    request.headers().iter().filter(of_name).map(|h| h.value.as_str().trim()).collect()
}

/// Takes as long wherever the two differ.
fn same(a: &str, b: &str) -> bool {
    a.len() == b.len() && a.bytes().zip(b.bytes()).fold(0, |differs, (a, b)| differs | (a ^ b)) == 0
}

/// Answers a request; `is_read`: of one whose body was read, or that has none.
pub fn send(request: Request, answer: &Answer, is_read: bool) {
    let headers = headers(answer);
    if !is_read {
        // What is left of the body is read after this answer, and not before it as below.
        let header = |(name, value): &(&str, String)| Header::from_bytes(*name, value.as_bytes()).ok();
        let response = tiny_http::Response::from_data(&answer.body[..]).with_status_code(answer.status);
        let response =
            headers.iter().filter_map(header).fold(response, |response, h| response.with_header(h));
        let _ = request.respond(response);
        return;
    }
    // In one piece: the second of two waits for the first to be acknowledged, some 40 ms.
    let mut bytes = format!("HTTP/1.1 {} {}\r\n", answer.status, phrase(answer.status)).into_bytes();
    for (name, value) in headers {
        bytes.extend(format!("{name}: {value}\r\n").into_bytes());
    }
    bytes.extend(format!("Content-Length: {}\r\n\r\n", answer.body.len()).into_bytes());
    bytes.extend(&answer.body);
    let mut writer = request.into_writer();
    // A page that has gone is no fault.
    let _ = writer.write_all(&bytes).and_then(|()| writer.flush());
}

fn headers(answer: &Answer) -> Vec<(&'static str, String)> {
    let policy = match &answer.nonce {
        Some(nonce) => format!(
            "default-src 'none'; script-src 'nonce-{nonce}'; style-src 'nonce-{nonce}'; img-src data:; \
             connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
        ),
        None => "default-src 'none'; frame-ancestors 'none'".to_string(),
    };
    vec![
        ("Content-Type", format!("{}; charset=utf-8", answer.kind)),
        ("Content-Security-Policy", policy),
        ("X-Content-Type-Options", "nosniff".into()),
        ("Referrer-Policy", "no-referrer".into()),
        ("Cache-Control", "no-store".into()),
        ("Cross-Origin-Resource-Policy", "same-origin".into()),
        ("Cross-Origin-Opener-Policy", "same-origin".into()),
    ]
}

fn phrase(status: u16) -> &'static str {
    match status {
        200 => "OK",
        400 => "Bad Request",
        403 => "Forbidden",
        404 => "Not Found",
        405 => "Method Not Allowed",
        409 => "Conflict",
        _ => "Internal Server Error",
    }
}
