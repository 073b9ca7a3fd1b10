//! Access control of the local server: secret URL, checks of Host (DNS rebinding) and Origin (CSRF).
//!
//! The URL contains 128 random bits; a request without these bits gets status 404. A page of another site may
//! make its own domain name resolve to 127.0.0.1 (DNS rebinding). The Host header must therefore name this
//! server. A page of another site may also post to this server from the user's browser (cross-site request
//! forgery, CSRF). The Origin header of every POST must therefore be the origin of our page. All checks
//! precede the reading of a body.

use super::http_response::HttpResponse;
use hyper::body::Incoming;
use hyper::header::{HOST, HeaderName, ORIGIN};
use hyper::{Method, Request, StatusCode};

/// Secret URL of the page, and the checks of every request.
pub struct AccessControl {
    token: String,
    port: u16,
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
    /// Returns the access control of the server on `port`. The URL of this server contains the secret
    /// `token`.
    pub fn new(token: String, port: u16) -> Self {
        Self { token, port }
    }

    /// Returns the URL of the page, including the secret.
    pub fn url(&self) -> String {
        format!("http://127.0.0.1:{}/{}/", self.port, self.token)
    }

    /// Checks the head of a request and returns the part of its path after the secret.
    ///
    /// # Errors
    /// Returns the response to a request that fails a check.
    pub fn admit(&self, request: &Request<Incoming>) -> Result<String, HttpResponse> {
        let forbidden = |why| Err(HttpResponse::refused(StatusCode::FORBIDDEN, why));
        let target = request.uri().to_string();
        let inside = target.strip_prefix('/').and_then(|path| path.split_once('/'));
        let inside = inside.filter(|(token, _)| same(token, &self.token)).map(|(_, inside)| inside);
        let Some(inside) = inside else {
            return Err(HttpResponse::refused(StatusCode::NOT_FOUND, "not found"));
        };
        // DNS rebinding: a foreign name that resolves to 127.0.0.1 belongs to another page.
        let hosts = ["127.0.0.1", "localhost"].map(|name| format!("{name}:{}", self.port));
        if !is_one_of(request, HOST, &hosts) {
            return forbidden("the Host header is not the address of this server");
        }
        match *request.method() {
            Method::GET => {}
            Method::POST => {
                // CSRF: a page of another origin must not change anything.
                if !is_one_of(request, ORIGIN, &hosts.map(|host| format!("http://{host}"))) {
                    return forbidden("the Origin header is not the origin of this page");
                }
            }
            _ => {
                let why = "the method must be GET or POST";
                return Err(HttpResponse::refused(StatusCode::METHOD_NOT_ALLOWED, why));
            }
        }
        Ok(inside.to_string())
    }
}

/// Returns whether a header occurs exactly once and equals one of `values`, which are in lower case. The
/// case of the header is ignored.
fn is_one_of(request: &Request<Incoming>, name: HeaderName, values: &[String]) -> bool {
    let mut found = request.headers().get_all(name).iter();
    let (Some(only), None) = (found.next(), found.next()) else { return false };
    only.to_str().is_ok_and(|only| values.contains(&only.trim().to_ascii_lowercase()))
}

/// Returns whether two texts are equal, in a time that does not depend on where they differ.
fn same(a: &str, b: &str) -> bool {
    a.len() == b.len() && a.bytes().zip(b.bytes()).fold(0, |differs, (a, b)| differs | (a ^ b)) == 0
}
