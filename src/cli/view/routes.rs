//! Routes of the local server: the response to each path.

use super::LiveView;
use super::access_control::secret;
use super::http_response::HttpResponse;
use super::requests::{EmptyBody, SaveBody, object, typed};
use super::save::Unsaved;
use crate::cli::mutex::locked;
use crate::cli::output;
use crate::files::shown;
use crate::report;
use crate::report::json::{LiveRefusal, LiveSaved};
use hyper::StatusCode;
use serde::Serialize;
use serde_json::{Map, Value};

/// Returns the response to an admitted request. `body` is None for a GET.
pub fn answer(view: &LiveView, inside: &str, body: Option<&[u8]>) -> HttpResponse {
    match body.map(object) {
        None => got(view, inside),
        Some(Ok(asked)) => posted(view, inside, asked),
        Some(Err(why)) => bad(&why),
    }
}

fn got(view: &LiveView, inside: &str) -> HttpResponse {
    match inside {
        "" => page(),
        "state" => said(view.state()),
        "now" => said(view.now()),
        "reach" => said(view.reach()),
        "room" => said(view.room()),
        "drawing" => said(view.drawing()),
        "pulse" => said(Ok(view.pulse())),
        _ => HttpResponse::refused(StatusCode::NOT_FOUND, "not found"),
    }
}

/// Returns the page. The scripts and styles of the page carry a nonce that is unique to this response.
fn page() -> HttpResponse {
    let page = secret().and_then(|nonce| HttpResponse::page(&nonce, report::page::live(&nonce)));
    page.unwrap_or_else(|why| HttpResponse::refused(StatusCode::INTERNAL_SERVER_ERROR, &why))
}

fn said(document: Result<impl Serialize, String>) -> HttpResponse {
    match document {
        Ok(document) => HttpResponse::json(StatusCode::OK, &document),
        Err(why) => bad(&why),
    }
}

fn bad(why: &str) -> HttpResponse {
    HttpResponse::refused(StatusCode::BAD_REQUEST, why)
}

fn posted(view: &LiveView, inside: &str, asked: Map<String, Value>) -> HttpResponse {
    let done = match inside {
        "try" | "try-drawing" => return said(view.attempt(&asked, inside != "try")),
        "standing" => return said(typed(asked).and_then(|asked| view.standing(&asked))),
        "save" => return typed(asked).map_or_else(|why| bad(&why), |asked| save(view, &asked)),
        "layout" => view.change(&asked),
        "search" => typed(asked).and_then(|asked| view.search(&asked)),
        "question" => typed(asked).and_then(|asked| view.ask(asked)),
        "accept" => typed(asked).and_then(|EmptyBody {}| view.accept()),
        "stop" => typed(asked).map(|EmptyBody {}| view.stop()),
        "reset" => typed(asked).map(|EmptyBody {}| view.reset()),
        "undo" | "redo" => typed(asked).map(|EmptyBody {}| locked(&view.session).travel(inside == "undo")),
        _ => return HttpResponse::refused(StatusCode::NOT_FOUND, "not found"),
    };
    match (done, inside) {
        (Err(why), _) => bad(&why),
        (Ok(()), "search" | "stop") => HttpResponse::json(StatusCode::OK, &view.pulse()),
        (Ok(()), _) => said(view.now()),
    }
}

fn save(view: &LiveView, asked: &SaveBody) -> HttpResponse {
    let (question, values) = {
        let session = locked(&view.session);
        (session.question.clone(), session.now().values.clone())
    };
    let workcell = match view.workcells.ask(&question) {
        Ok(workcell) => workcell,
        Err(why) => return bad(&why),
    };
    // Only one save runs at a time, so that no other save creates the file after the check.
    let _one = locked(&view.saving);
    match view.origin.save(&asked.name, asked.overwrite, &workcell.cell, &values) {
        Ok(path) => {
            let path = output::path_word(&path);
            output::talk(&format!("wrote {path}"));
            HttpResponse::json(StatusCode::OK, &LiveSaved { saved: path.to_string() })
        }
        Err(Unsaved::FileExists) => {
            let why = format!("the file `{}` already exists", shown(asked.name.trim()));
            HttpResponse::json(StatusCode::CONFLICT, &LiveRefusal { error: &why, taken: true })
        }
        Err(Unsaved::Refused(why)) => bad(&why),
        Err(Unsaved::Io) => {
            let why = "the file cannot be written: see the terminal";
            HttpResponse::refused(StatusCode::INTERNAL_SERVER_ERROR, why)
        }
    }
}
