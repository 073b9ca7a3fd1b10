//! Reduced copy of a URDF: only the links and joints that are used, with only the elements that are read.

use super::outline::UrdfOutline;
use super::xml::right_angle;
use roxmltree::{Document, Node};
use std::collections::{HashMap, HashSet};
use std::f64::consts::TAU;
use std::fmt::Write;

/// Copies the links in `outline.links`, and the joints between these links, from a URDF.
///
/// `meshes` maps the path of a mesh file in the URDF to the path in the copy. If `meshes` lacks a mesh file,
/// the copy omits the shape of this mesh. If an angle is a rounded multiple of a right angle, the copy states
/// the multiple with all digits. Continuous joints get the limits that the reader assumes for them. `about`
/// becomes a comment.
pub fn lean(
    text: &str,
    outline: &UrdfOutline,
    meshes: &HashMap<String, String>,
    about: &str,
) -> Option<String> {
    let document = Document::parse(text).ok()?;
    let root = document.root_element();
    let links: HashSet<&str> = outline.links.iter().map(String::as_str).collect();
    let mut out = format!("<?xml version=\"1.0\"?>\n<!-- {} -->\n", about.replace("--", "- -"));
    let _ = writeln!(out, "<robot{}>", attribute(&root, "name"));
    for e in root.children().filter(Node::is_element) {
        let end = |tag| child(&e, tag).and_then(|end| end.attribute("link"));
        match e.tag_name().name() {
            "link" if e.attribute("name").is_some_and(|name| links.contains(name)) => {
                link(&e, meshes, &mut out)
            }
            "joint" if [end("parent"), end("child")].iter().all(|l| l.is_some_and(|l| links.contains(l))) => {
                joint(&e, &mut out);
            }
            _ => {}
        }
    }
    out += "</robot>\n";
    Some(out)
}

fn link(e: &Node<'_, '_>, meshes: &HashMap<String, String>, out: &mut String) {
    let mut shapes = String::new();
    for collision in e.children().filter(|c| c.has_tag_name("collision")) {
        let Some(shape) = child(&collision, "geometry").and_then(|g| g.first_element_child()) else {
            continue;
        };
        let mut shape_text = String::new();
        for a in shape.attributes() {
            let value = match a.name() {
                "filename" => match meshes.get(a.value()) {
                    Some(path) => path,
                    _ => continue,
                },
                _ => a.value(),
            };
            let _ = write!(shape_text, " {}=\"{}\"", a.name(), escaped(value));
        }
        let name = shape.tag_name().name();
        if name == "mesh" && !shape_text.contains(" filename=") {
            continue;
        }
        let (origin, open) = (origin(&collision), "<geometry><");
        let _ = writeln!(shapes, "    <collision>{origin}{open}{name}{shape_text}/></geometry></collision>");
    }
    let name = attribute(e, "name");
    let _ = match shapes.is_empty() {
        true => writeln!(out, "  <link{name}/>"),
        false => writeln!(out, "  <link{name}>\n{shapes}  </link>"),
    };
}

fn joint(e: &Node<'_, '_>, out: &mut String) {
    let is_continuous = e.attribute("type") == Some("continuous");
    let kind = if is_continuous { " type=\"revolute\"".to_string() } else { attribute(e, "type") };
    let _ = write!(out, "  <joint{}{kind}>{}", attribute(e, "name"), origin(e));
    for tag in ["parent", "child", "axis", "limit", "mimic"] {
        let Some(part) = child(e, tag).filter(|_| !(is_continuous && tag == "limit")) else { continue };
        let all: String = part.attributes().map(|a| attribute(&part, a.name())).collect();
        let _ = write!(out, "<{tag}{all}/>");
    }
    if is_continuous {
        let velocity = child(e, "limit").map_or(String::new(), |limit| attribute(&limit, "velocity"));
        let _ = write!(out, "<limit lower=\"-{TAU}\" upper=\"{TAU}\"{velocity}/>");
    }
    *out += "</joint>\n";
}

/// Returns the `<origin>` of an element; empty if it has none.
fn origin(e: &Node<'_, '_>) -> String {
    let Some(origin) = child(e, "origin") else { return String::new() };
    let rpy = origin.attribute("rpy").map_or(String::new(), |rpy| {
        let angles = rpy.split_ascii_whitespace().map(|word| match word.parse::<f64>() {
            Ok(value) if right_angle(word, value) != value => right_angle(word, value).to_string(),
            _ => word.to_string(),
        });
        format!(" rpy=\"{}\"", escaped(&angles.collect::<Vec<_>>().join(" ")))
    });
    format!("<origin{}{rpy}/>", attribute(&origin, "xyz"))
}

fn child<'a, 'i>(e: &Node<'a, 'i>, tag: &str) -> Option<Node<'a, 'i>> {
    e.children().find(|c| c.has_tag_name(tag))
}

/// Returns an attribute as it is written in a tag; empty if the element does not have it.
fn attribute(e: &Node<'_, '_>, name: &str) -> String {
    e.attribute(name).map_or(String::new(), |value| format!(" {name}=\"{}\"", escaped(value)))
}

fn escaped(value: &str) -> String {
    value.replace('&', "&amp;").replace('<', "&lt;").replace('"', "&quot;")
}
