//! Page of `view`, served by a thread of this process.

use super::{AccessControl, LiveView, LocalServer, Origin, secret};
use std::sync::Arc;
use std::thread::JoinHandle;
use tokio::sync::Notify;

/// Server of a live page, running in its own thread. The server ends when this value is dropped.
pub struct BackgroundView {
    url: String,
    over: Arc<Notify>,
    thread: Option<JoinHandle<()>>,
}

impl BackgroundView {
    /// Serves a page for the cell of `workcell` on a port of 127.0.0.1. Port 0 lets the operating system
    /// choose a port.
    ///
    /// # Errors
    /// Returns the reason if the port cannot be opened, or if the operating system provides no random bits.
    pub fn new(workcell: crate::layout::Workcell, origin: Origin, port: u16) -> Result<Self, String> {
        let view = LiveView::new(workcell, origin);
        let server =
            LocalServer::bind(port).map_err(|e| format!("cannot listen on 127.0.0.1:{port}: {e}"))?;
        let access = AccessControl::new(secret()?, server.port());
        let (url, over) = (access.url(), Arc::new(Notify::new()));
        let ends = over.clone();
        let thread = std::thread::spawn(move || server.serve(view, access, &ends));
        Ok(Self { url, over, thread: Some(thread) })
    }

    /// Returns the URL of the page, including the secret.
    pub fn url(&self) -> &str {
        &self.url
    }

    /// Ends the server. Does nothing if the server has already ended.
    pub fn stop(&mut self) {
        self.over.notify_one();
        if let Some(thread) = self.thread.take() {
            let _ = thread.join();
        }
    }
}

impl Drop for BackgroundView {
    fn drop(&mut self) {
        self.stop();
    }
}
