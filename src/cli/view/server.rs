//! Local web server with limits on connections, headers, bodies and time.
//!
//! Anybody on this machine can connect. A connection without the secret must therefore cost little. The
//! head of a request is limited in size and must arrive within a time limit. The server reads no body and
//! starts no thread for such a connection. One thread accepts and serves all connections. The response to
//! each admitted request is computed in a separate thread, so a long computation delays no other request.

use super::LiveView;
use super::access_control::AccessControl;
use super::http_response::HttpResponse;
use super::routes;
use crate::cli::output;
use http_body_util::{BodyExt, Full, LengthLimitError, Limited};
use hyper::body::{Body, Bytes, Incoming};
use hyper::server::conn::http1;
use hyper::service::service_fn;
use hyper::{Method, Request, Response, StatusCode};
use hyper_util::rt::{TokioIo, TokioTimer};
use std::convert::Infallible;
use std::net::Ipv4Addr;
use std::sync::Arc;
use std::time::Duration;
use tokio::net::{TcpListener, TcpStream};
use tokio::runtime::{Builder, Runtime};
use tokio::sync::{Notify, OwnedSemaphorePermit, Semaphore, oneshot};
use tokio::time::{sleep, timeout};
use tokio_io_timeout::TimeoutStream;

/// Largest number of open connections; further connections wait in the queue of the operating system.
const MAX_CONNECTIONS: usize = 64;
/// Largest head of a request, bytes: request line and headers.
const MAX_HEAD_BYTES: usize = 16 << 10;
/// Largest number of headers of a request.
const MAX_HEADERS: usize = 100;
/// Largest body of a request, bytes; requests of the page have a few hundred bytes.
const MAX_BODY_BYTES: usize = 64 << 10;
/// Longest time that the server waits for the head of each request of a connection.
const HEAD_TIME: Duration = Duration::from_secs(5);
/// Longest time that the server waits for the body of a request.
const BODY_TIME: Duration = Duration::from_secs(10);
/// Longest wait for a client that accepts no byte of a response.
const SEND_TIME: Duration = Duration::from_secs(10);
/// Pause after a failure to accept a connection. The usual cause is too many open files.
const ACCEPT_PAUSE: Duration = Duration::from_millis(100);

/// Session and access control that all connections share.
type Shared = Arc<(LiveView, AccessControl)>;

/// Local web server that listens, but accepts no connection before [`LocalServer::serve`].
pub struct LocalServer {
    runtime: Runtime,
    listener: TcpListener,
    port: u16,
}

impl LocalServer {
    /// Listens on a port of 127.0.0.1. Port 0 lets the operating system choose a port.
    ///
    /// # Errors
    /// Fails if the port is in use, or if this program may not open it.
    pub fn bind(port: u16) -> std::io::Result<Self> {
        let runtime = Builder::new_current_thread().enable_all().build()?;
        let listener = runtime.block_on(TcpListener::bind((Ipv4Addr::LOCALHOST, port)))?;
        let port = listener.local_addr()?.port();
        Ok(Self { runtime, listener, port })
    }

    /// Returns the port on which the server listens.
    pub fn port(&self) -> u16 {
        self.port
    }

    /// Answers requests until `over` is notified.
    pub fn serve(self, view: LiveView, access: AccessControl, over: &Notify) {
        self.runtime.spawn(accept(self.listener, Arc::new((view, access))));
        self.runtime.block_on(over.notified());
    }
}

/// Accepts connections in an endless loop. Pauses after each failure, and reports only the first failure.
async fn accept(listener: TcpListener, shared: Shared) {
    let slots = Arc::new(Semaphore::new(MAX_CONNECTIONS));
    let mut is_reported = false;
    // Nobody closes the semaphore, so this loop never ends.
    while let Ok(slot) = slots.clone().acquire_owned().await {
        match listener.accept().await {
            Ok((stream, _)) => {
                tokio::spawn(connection(stream, shared.clone(), slot));
            }
            Err(e) => {
                if !is_reported {
                    output::talk(&format!(
                        "note: a connection could not be accepted ({e}): it waits until others are closed; \
                         further failures are not reported"
                    ));
                }
                is_reported = true;
                sleep(ACCEPT_PAUSE).await;
            }
        }
    }
}

/// Answers the requests of one connection until the connection ends or exceeds a limit.
async fn connection(stream: TcpStream, shared: Shared, slot: OwnedSemaphorePermit) {
    // Without this option, Nagle's algorithm may delay the last packet of a response until an acknowledgement
    // arrives.
    let _ = stream.set_nodelay(true);
    let mut stream = TimeoutStream::new(stream);
    stream.set_write_timeout(Some(SEND_TIME));
    let slot = Arc::new(slot);
    let service = service_fn(move |request| answer(request, shared.clone(), slot.clone()));
    let served = http1::Builder::new()
        .timer(TokioTimer::new())
        .header_read_timeout(HEAD_TIME)
        .max_headers(MAX_HEADERS)
        .max_buf_size(MAX_HEAD_BYTES)
        .serve_connection(TokioIo::new(Box::pin(stream)), service);
    // A client that leaves, is too slow or sends no HTTP is not an error of this program.
    let _ = served.await;
}

async fn answer(
    request: Request<Incoming>,
    shared: Shared,
    slot: Arc<OwnedSemaphorePermit>,
) -> Result<Response<Full<Bytes>>, Infallible> {
    let answer = computed(request, shared, slot).await;
    Ok(answer.unwrap_or_else(|refusal| refusal).into_http())
}

/// Admits a request, reads its body and computes the response in a separate thread.
///
/// Each connection occupies one of [`MAX_CONNECTIONS`] slots. The thread holds `slot` until it ends, so a
/// client cannot start more threads by disconnecting early.
async fn computed(
    request: Request<Incoming>,
    shared: Shared,
    slot: Arc<OwnedSemaphorePermit>,
) -> Result<HttpResponse, HttpResponse> {
    let inside = shared.1.admit(&request)?;
    let body = if request.method() == Method::POST { Some(whole(request.into_body()).await?) } else { None };
    let (send, received) = oneshot::channel();
    let compute = move || {
        let _slot = slot;
        // A client that has left meanwhile is not an error.
        let _ = send.send(routes::answer(&shared.0, &inside, body.as_deref()));
    };
    let failed = |why: &str| HttpResponse::refused(StatusCode::INTERNAL_SERVER_ERROR, why);
    let thread = std::thread::Builder::new().name("request".into()).spawn(compute);
    thread.map_err(|e| failed(&format!("cannot start a thread: {e}")))?;
    received.await.map_err(|_| failed("the request failed: see the terminal"))
}

/// Reads the whole body of a request.
///
/// # Errors
/// Returns the response to a request whose body is too long, too slow or incomplete.
async fn whole(mut body: Incoming) -> Result<Bytes, HttpResponse> {
    if body.size_hint().lower() > MAX_BODY_BYTES as u64 {
        return Err(too_long(body));
    }
    match timeout(BODY_TIME, Limited::new(&mut body, MAX_BODY_BYTES).collect()).await {
        Ok(Ok(whole)) => Ok(whole.to_bytes()),
        Ok(Err(e)) if e.is::<LengthLimitError>() => Err(too_long(body)),
        Ok(Err(_)) => Err(HttpResponse::refused(StatusCode::BAD_REQUEST, "the body is incomplete")),
        Err(_) => {
            let why = format!("the body did not arrive within {} s", BODY_TIME.as_secs());
            Err(HttpResponse::refused(StatusCode::REQUEST_TIMEOUT, &why))
        }
    }
}

/// Returns the response to a body that is too long, and discards the rest of that body.
fn too_long(mut body: Incoming) -> HttpResponse {
    // If the connection were closed while the client still sends, the client would lose the response.
    tokio::spawn(timeout(BODY_TIME, async move { while let Some(Ok(_)) = body.frame().await {} }));
    let why = format!("the body has more than {MAX_BODY_BYTES} bytes");
    HttpResponse::refused(StatusCode::PAYLOAD_TOO_LARGE, &why)
}
