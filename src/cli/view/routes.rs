//! What can be asked of the page's address.

use super::View;
use super::door;
use super::door::{Answer, Door};
use super::locked;
use super::save::Unsaved;
use crate::cli::output;
use crate::files::shown;
use crate::report;
use serde_json::{Value, json};
use tiny_http::{Method, Request};

/// Answers one request.
pub fn answer(view: &View, door: &Door, mut request: Request) {
    let (answer, is_read) = match door.admit(&request) {
        Err(refusal) => (refusal, false),
        Ok(inside) if *request.method() == Method::Get => (got(view, &inside), true),
        Ok(inside) => match door::body(&mut request) {
            Err(refusal) => (refusal, false),
            Ok(body) => (posted(view, &inside, &body), true),
        },
    };
    // What is left of a body would be read first.
    let is_read =
        is_read && (*request.method() == Method::Post || request.body_length().is_none_or(|n| n == 0));
    door::send(request, &answer, is_read);
}

fn got(view: &View, inside: &str) -> Answer {
    let document = match inside {
        "" => return page(),
        "state" => view.state(),
        "now" => view.now(),
        "reach" => view.reach(),
        "drawing" => view.drawing(),
        "pulse" => Ok(view.pulse()),
        _ => return Answer::refused(404, "there is nothing here"),
    };
    said(document)
}

/// A page with marks that its scripts and styles alone have.
fn page() -> Answer {
    match door::secret() {
        Ok(nonce) => {
            let body = report::page::live(&nonce).into_bytes();
            Answer { status: 200, kind: "text/html", body, nonce: Some(nonce) }
        }
        Err(why) => Answer::refused(500, &why),
    }
}

fn said(document: Result<Value, String>) -> Answer {
    match document {
        Ok(document) => Answer::json(200, &document),
        Err(why) => Answer::refused(400, &why),
    }
}

fn posted(view: &View, inside: &str, body: &[u8]) -> Answer {
    let asked: Value = match serde_json::from_slice(body) {
        Ok(asked) => asked,
        Err(e) => return Answer::refused(400, &format!("the request is no JSON: {e}")),
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
        _ => return Answer::refused(404, "there is nothing here"),
    };
    match (done, inside) {
        (Err(why), _) => Answer::refused(400, &why),
        (Ok(()), "search" | "stop") => Answer::json(200, &view.pulse()),
        (Ok(()), _) => said(view.now()),
    }
}

fn save(view: &View, asked: &Value) -> Answer {
    let Some(name) = asked.get("name").and_then(Value::as_str) else {
        return Answer::refused(400, "`name` must be a word");
    };
    let overwrite = asked.get("overwrite").and_then(Value::as_bool).unwrap_or(false);
    let (question, values) = {
        let session = locked(&view.session);
        (session.question.clone(), session.now().values.clone())
    };
    let workcell = match view.workcells.ask(&question) {
        Ok(workcell) => workcell,
        Err(why) => return Answer::refused(400, &why),
    };
    // One at a time: what is not there when it is looked for is not there when it is written.
    let _one = locked(&view.saving);
    match view.origin.save(name, overwrite, &workcell.cell, &values) {
        Ok(path) => {
            let path = output::path_word(&path);
            output::talk(&format!("wrote {path}"));
            Answer::json(200, &json!({ "saved": path }))
        }
        Err(Unsaved::Taken) => Answer::json(
            409,
            &json!({
                "error": format!("there is a file `{}` already", shown(name.trim())), "taken": true
            }),
        ),
        Err(Unsaved::Refused(why)) => Answer::refused(400, &why),
        Err(Unsaved::Io) => Answer::refused(500, "it cannot be written: the terminal says why"),
    }
}
