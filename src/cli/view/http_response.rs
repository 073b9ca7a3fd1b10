//! Responses of the local server. A content security policy keeps the page from loading anything from other
//! sites.

use crate::report::json::{LiveRefusal, value};
use http_body_util::Full;
use hyper::body::Bytes;
use hyper::header::{HeaderName, HeaderValue};
use hyper::{Response, StatusCode, header};
use serde::Serialize;

/// Response to a request.
pub struct HttpResponse {
    status: StatusCode,
    /// Media type of the body.
    kind: &'static str,
    /// Content security policy.
    policy: HeaderValue,
    body: Vec<u8>,
}

impl HttpResponse {
    /// Returns a response that refuses a request and says why.
    pub fn refused(status: StatusCode, why: &str) -> Self {
        Self::json(status, &LiveRefusal { error: why, taken: false })
    }

    /// Returns a response with a JSON document.
    pub fn json(status: StatusCode, record: &impl Serialize) -> Self {
        let policy = HeaderValue::from_static("default-src 'none'; frame-ancestors 'none'");
        let body = value(record).to_string().into_bytes();
        Self { status, kind: "application/json; charset=utf-8", policy, body }
    }

    /// Returns a response with the page `html`. The content security policy admits only scripts and styles
    /// that carry `nonce`.
    ///
    /// # Errors
    /// Fails if the nonce cannot be part of a header.
    pub fn page(nonce: &str, html: String) -> Result<Self, String> {
        let policy = format!(
            "default-src 'none'; script-src 'nonce-{nonce}'; style-src 'nonce-{nonce}'; img-src data:; \
             connect-src 'self'; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
        );
        let policy = HeaderValue::try_from(policy).map_err(|e| e.to_string())?;
        Ok(Self { status: StatusCode::OK, kind: "text/html; charset=utf-8", policy, body: html.into_bytes() })
    }

    /// Returns the response as hyper sends it.
    pub fn into_http(self) -> Response<Full<Bytes>> {
        let mut response = Response::new(Full::from(self.body));
        *response.status_mut() = self.status;
        let headers = response.headers_mut();
        headers.insert(header::CONTENT_SECURITY_POLICY, self.policy);
        for (name, value) in [
            (header::CONTENT_TYPE, self.kind),
            (header::X_CONTENT_TYPE_OPTIONS, "nosniff"),
            (header::REFERRER_POLICY, "no-referrer"),
            (header::CACHE_CONTROL, "no-store"),
            (HeaderName::from_static("cross-origin-resource-policy"), "same-origin"),
            (HeaderName::from_static("cross-origin-opener-policy"), "same-origin"),
        ] {
            headers.insert(name, HeaderValue::from_static(value));
        }
        response
    }
}
