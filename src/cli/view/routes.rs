//! Routes of the local server: the response to each path.

use super::LiveView;
use super::access_control;
use super::access_control::{AccessControl, HttpResponse};
use super::locked;
use super::save::Unsaved;
use crate::cli::output;
use crate::files::shown;
use crate::report;
use serde_json::{Value, json};
use tiny_http::{Method, Request};

/// Answers one request.
pub fn answer(view: &LiveView, access: &AccessControl, mut request: Request) {
    let (answer, is_read) = match access.admit(&request) {
        Err(refusal) => (refusal, false),
        Ok(inside) if *request.method() == Method::Get => (got(view, &inside), true),
        Ok(inside) => match access_control::body(&mut request) {
            Err(refusal) => (refusal, false),
            Ok(body) => (posted(view, &inside, &body), true),
        },
    };
    // tiny_http would first read the rest of a body.
    let is_read =
        is_read && (*request.method() == Method::Post || request.body_length().is_none_or(|n| n == 0));
    access_control::send(request, &answer, is_read);
}

fn got(view: &LiveView, inside: &str) -> HttpResponse {
    let document = match inside {
        "" => return page(),
        "state" => view.state(),
        "now" => view.now(),
        "reach" => view.reach(),
        "drawing" => view.drawing(),
        "pulse" => Ok(view.pulse()),
        _ => return HttpResponse::refused(404, "not found"),
    };
    said(document)
}

/// Returns the page. Its scripts and styles carry a nonce that is unique to this response.
fn page() -> HttpResponse {
    match access_control::secret() {
        Ok(nonce) => {
            let body = report::page::live(&nonce).into_bytes();
            HttpResponse { status: 200, kind: "text/html", body, nonce: Some(nonce) }
        }
        Err(why) => HttpResponse::refused(500, &why),
    }
}

fn said(document: Result<Value, String>) -> HttpResponse {
    match document {
        Ok(document) => HttpResponse::json(200, &document),
        Err(why) => HttpResponse::refused(400, &why),
    }
}

fn posted(view: &LiveView, inside: &str, body: &[u8]) -> HttpResponse {
    let asked: Value = match serde_json::from_slice(body) {
        Ok(asked) => asked,
        Err(e) => return HttpResponse::refused(400, &format!("the request is not JSON: {e}")),
    };
    let done = match inside {
        "try" | "try-drawing" => return said(view.attempt(&asked, inside != "try")),
        "save" => return save(view, &asked),
        "search" => view.search(&asked),
        "stop" => {
            view.stop();
            Ok(())
        }
        "layout" => view.change(&asked),
        "question" => view.ask(&asked),
        "accept" => view.accept(),
        "undo" | "redo" => {
            locked(&view.session).travel(inside == "undo");
            Ok(())
        }
        "reset" => {
            view.reset();
            Ok(())
        }
        _ => return HttpResponse::refused(404, "not found"),
    };
    match (done, inside) {
        (Err(why), _) => HttpResponse::refused(400, &why),
        (Ok(()), "search" | "stop") => HttpResponse::json(200, &view.pulse()),
        (Ok(()), _) => said(view.now()),
    }
}

fn save(view: &LiveView, asked: &Value) -> HttpResponse {
    let Some(name) = asked.get("name").and_then(Value::as_str) else {
        return HttpResponse::refused(400, "`name` must be a string");
    };
    let overwrite = asked.get("overwrite").and_then(Value::as_bool).unwrap_or(false);
    let (question, values) = {
        let session = locked(&view.session);
        (session.question.clone(), session.now().values.clone())
    };
    let workcell = match view.workcells.ask(&question) {
        Ok(workcell) => workcell,
        Err(why) => return HttpResponse::refused(400, &why),
    };
    // One at a time, so that a file does not appear between the check and the write.
    let _one = locked(&view.saving);
    match view.origin.save(name, overwrite, &workcell.cell, &values) {
        Ok(path) => {
            let path = output::path_word(&path);
            output::talk(&format!("wrote {path}"));
            HttpResponse::json(200, &json!({ "saved": path }))
        }
        Err(Unsaved::OccupiedBoxes) => HttpResponse::json(
            409,
            &json!({
                "error": format!("the file `{}` already exists", shown(name.trim())), "taken": true
            }),
        ),
        Err(Unsaved::Refused(why)) => HttpResponse::refused(400, &why),
        Err(Unsaved::Io) => HttpResponse::refused(500, "the file cannot be written: see the terminal"),
    }
}
