//! Access control of the local server: secret URL, checks of Host (DNS rebinding) and Origin (CSRF).
//!
//! The URL contains 128 random bits; a request without these bits gets status 404. A page of another site may
//! make its own domain name resolve to 127.0.0.1 (DNS rebinding), so the Host header must name this server.
//! Such a page may also post to this server from the user's browser (cross-site request forgery, CSRF). The
//! Origin header of every POST must therefore be that of our page. A content security policy keeps the page
//! from loading anything else.

use std::io::Read;
use tiny_http::{Header, Method, Request};

/// Largest body of a request, bytes; requests of the page have a few hundred bytes.
const MAX_BODY_BYTES: usize = 64 << 10;

/// Secret URL of the page, and the checks of every request.
pub struct AccessControl {
    token: String,
    port: u16,
}

/// Response to a request.
pub struct HttpResponse {
    pub status: u16,
    /// Media type of the body.
    pub kind: &'static str,
    pub body: Vec<u8>,
    /// Nonce of the scripts and styles of the page; None if the body is no page.
    pub nonce: Option<String>,
}

impl HttpResponse {
    /// Returns a response that refuses a request and says why.
    pub fn refused(status: u16, why: &str) -> Self {
        Self::json(status, &serde_json::json!({ "error": why }))
    }

    /// Returns a response with a JSON document.
    pub fn json(status: u16, value: &serde_json::Value) -> Self {
        let body = value.to_string().into_bytes();
        Self { status, kind: "application/json", body, nonce: None }
    }
}

/// Returns 128 random bits from the operating system in hexadecimal.
///
/// # Errors
/// Fails if the operating system provides no random bits.
pub fn secret() -> Result<String, String> {
    let mut bytes = [0u8; 16];
    getrandom::fill(&mut bytes)
        .map_err(|e| format!("the operating system provides no random numbers: {e}"))?;
    Ok(bytes.iter().map(|b| format!("{b:02x}")).collect())
}

impl AccessControl {
    /// Returns the access control of a server on a port, with its secret.
    pub fn new(token: String, port: u16) -> Self {
        Self { token, port }
    }

    /// Returns the URL of the page, including the secret.
    pub fn url(&self) -> String {
        format!("http://127.0.0.1:{}/{}/", self.port, self.token)
    }

    /// Checks a request and returns the part of its path after the secret.
    ///
    /// # Errors
    /// Returns the response to a request that fails a check.
    pub fn admit(&self, request: &Request) -> Result<String, HttpResponse> {
        let inside = request.url().strip_prefix('/').and_then(|path| path.split_once('/'));
        let inside = inside.filter(|(token, _)| same(token, &self.token)).map(|(_, inside)| inside);
        let Some(inside) = inside else { return Err(HttpResponse::refused(404, "not found")) };
        // DNS rebinding: a foreign name that resolves to 127.0.0.1 belongs to another page.
        let hosts = ["127.0.0.1", "localhost"].map(|name| format!("{name}:{}", self.port));
        match &header(request, "Host")[..] {
            [host] if hosts.contains(&host.to_ascii_lowercase()) => {}
            _ => return Err(HttpResponse::refused(403, "the Host header is not the address of this server")),
        }
        match request.method() {
            Method::Get => {}
            Method::Post => {
                // CSRF: a page of another origin must not change anything.
                let origins = hosts.map(|host| format!("http://{host}"));
                match &header(request, "Origin")[..] {
                    [origin] if origins.contains(&origin.to_ascii_lowercase()) => {}
                    _ => {
                        return Err(HttpResponse::refused(403, "the Origin header is not that of this page"));
                    }
                }
            }
            _ => return Err(HttpResponse::refused(405, "the method must be GET or POST")),
        }
        Ok(inside.to_string())
    }
}

/// Reads the whole body of a request.
///
/// # Errors
/// Returns the response to a request whose body has no length or is too long.
pub fn body(request: &mut Request) -> Result<Vec<u8>, HttpResponse> {
    let length = request.body_length().filter(|_| header(request, "Transfer-Encoding").is_empty());
    let length = length.ok_or_else(|| HttpResponse::refused(400, "the request has no Content-Length"))?;
    if length > MAX_BODY_BYTES {
        return Err(HttpResponse::refused(400, &format!("the body has more than {MAX_BODY_BYTES} bytes")));
    }
    let mut bytes = Vec::with_capacity(length);
    let read = request.as_reader().take(length as u64).read_to_end(&mut bytes);
    match read {
        Ok(count) if count == length => Ok(bytes),
        _ => Err(HttpResponse::refused(400, "the body is shorter than its Content-Length")),
    }
}

/// Returns the values of all headers with a name.
fn header<'r>(request: &'r Request, name: &'static str) -> Vec<&'r str> {
    let of_name = |h: &&Header| h.field.equiv(name);
    request.headers().iter().filter(of_name).map(|h| h.value.as_str().trim()).collect()
}

/// Compares two texts in a time that does not depend on where they differ.
fn same(a: &str, b: &str) -> bool {
    a.len() == b.len() && a.bytes().zip(b.bytes()).fold(0, |differs, (a, b)| differs | (a ^ b)) == 0
}

/// Sends a response. `is_read` states that the body of the request was read or is empty.
pub fn send(request: Request, answer: &HttpResponse, is_read: bool) {
    let headers = headers(answer);
    if !is_read {
        // tiny_http reads the rest of the body after this response, not before it as below.
        let header = |(name, value): &(&str, String)| Header::from_bytes(*name, value.as_bytes()).ok();
        let response = tiny_http::Response::from_data(&answer.body[..]).with_status_code(answer.status);
        let response =
            headers.iter().filter_map(header).fold(response, |response, h| response.with_header(h));
        let _ = request.respond(response);
        return;
    }
    // One write: a second one would wait about 40 ms for the acknowledgement of the first.
    let mut bytes = format!("HTTP/1.1 {} {}\r\n", answer.status, phrase(answer.status)).into_bytes();
    for (name, value) in headers {
        bytes.extend(format!("{name}: {value}\r\n").into_bytes());
    }
    bytes.extend(format!("Content-Length: {}\r\n\r\n", answer.body.len()).into_bytes());
    bytes.extend(&answer.body);
    let mut writer = request.into_writer();
    // A page that was closed meanwhile is no error.
    let _ = writer.write_all(&bytes).and_then(|()| writer.flush());
}

fn headers(answer: &HttpResponse) -> Vec<(&'static str, String)> {
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
