//! Working memory of the threads that evaluate layouts, kept from call to call.

use std::ops::{Deref, DerefMut};
use std::sync::Mutex;
use sweetspot::layout::Workspace;

/// Pool of working memories that no thread uses at present.
pub type Workspaces = Mutex<Vec<Workspace>>;

/// Working memory that one thread borrows from the evaluator.
pub struct Borrowed<'e> {
    pool: &'e Workspaces,
    workspace: Workspace,
}

impl<'e> Borrowed<'e> {
    pub fn new(pool: &'e Workspaces) -> Self {
        let workspace = pool.lock().unwrap_or_else(|poisoned| poisoned.into_inner()).pop();
        Self { pool, workspace: workspace.unwrap_or_default() }
    }
}

impl Deref for Borrowed<'_> {
    type Target = Workspace;

    fn deref(&self) -> &Workspace {
        &self.workspace
    }
}

impl DerefMut for Borrowed<'_> {
    fn deref_mut(&mut self) -> &mut Workspace {
        &mut self.workspace
    }
}

impl Drop for Borrowed<'_> {
    fn drop(&mut self) {
        let mut pool = self.pool.lock().unwrap_or_else(|poisoned| poisoned.into_inner());
        pool.push(std::mem::take(&mut self.workspace));
    }
}
