//! Recognition of a file by its content, so that no file is read as a file of another kind.

use crate::safe_text::shown;

/// Kind of a recognized file that is not a TOML file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FileContent {
    Urdf,
    Xacro,
    Collada,
    OtherXml,
    Stl,
    Obj,
    Dxf,
    Step,
    Json,
    Yaml,
    DataTable,
    Binary,
}

/// Number of bytes at the start of a file that are examined to recognize the file.
const HEAD: usize = 4_000;

impl FileContent {
    /// Returns the kind of the file with this content; None for TOML and for unrecognized content.
    pub fn of(bytes: &[u8]) -> Option<Self> {
        let head = &bytes[..bytes.len().min(HEAD)];
        let text = String::from_utf8_lossy(head);
        let text = text.trim_start_matches('\u{feff}').trim_start();
        if is_binary_stl(bytes) {
            return Some(Self::Stl);
        } else if text.starts_with("AutoCAD Binary DXF") {
            return Some(Self::Dxf);
        } else if head.contains(&0) || text.starts_with("%PDF-") {
            return Some(Self::Binary);
        } else if text.starts_with('<') {
            return Some(of_xml(text, bytes));
        } else if text.starts_with("ISO-10303-21") {
            return Some(Self::Step);
        } else if text.starts_with('{') {
            return Some(Self::Json);
        }
        let lines: Vec<&str> = text.lines().map(str::trim).collect();
        let is_ascii_stl = lines.first().is_some_and(|l| l.starts_with("solid") && !l.contains('='));
        if is_ascii_stl && (text.contains("facet normal") || text.contains("endsolid")) {
            return Some(Self::Stl);
        }
        if matches!(lines.first(), Some(&"0" | &"999")) && lines.contains(&"SECTION") {
            return Some(Self::Dxf);
        }
        // The last line may be cut off.
        let whole = if bytes.len() > HEAD { lines.len().saturating_sub(1) } else { lines.len() };
        let lines: Vec<&str> =
            lines.into_iter().take(whole).filter(|l| !l.is_empty() && !l.starts_with('#')).collect();
        if is_obj(&lines) {
            Some(Self::Obj)
        } else if lines.iter().any(|line| line.contains('=') || line.starts_with('[')) {
            None
        } else if is_yaml(&lines) {
            Some(Self::Yaml)
        } else {
            is_table(&lines).then_some(Self::DataTable)
        }
    }

    /// Returns whether the file is a mesh, a solid model, a drawing or an XML file. The recognition of any
    /// other kind is not certain. For example, a file that is recognized as a binary file may be a damaged
    /// STL mesh.
    pub fn is_shape(self) -> bool {
        !matches!(self, Self::Json | Self::Yaml | Self::DataTable | Self::Binary)
    }

    /// Returns the name of the kind for messages, with the indefinite article.
    pub fn in_words(self) -> &'static str {
        match self {
            Self::Urdf => "a URDF (the robot description of ROS)",
            Self::Xacro => "a xacro file (macros that expand to a URDF)",
            Self::Collada => "a COLLADA mesh",
            Self::OtherXml => "an XML file",
            Self::Stl => "an STL mesh",
            Self::Obj => "a Wavefront OBJ mesh",
            Self::Dxf => "a DXF drawing",
            Self::Step => "a STEP model",
            Self::Json => "a JSON file",
            Self::Yaml => "a YAML file",
            Self::DataTable => "a table of data",
            Self::Binary => "a binary file",
        }
    }

    /// Returns a help text that states what the user can do with the file at `path`. The path must already be
    /// quoted for a shell.
    pub fn next_step(self, path: &str) -> String {
        let mesh = "use the mesh in a solid: mesh = { file = \"NAME.stl\", units = \"mm\" }";
        match self {
            Self::Urdf | Self::Xacro => format!("write a cell for it: sweetspot init {path}"),
            Self::Collada | Self::Step => format!("convert it: {}; then {mesh}", conversion(path)),
            Self::OtherXml | Self::Binary => {
                "give a cell or robot file in TOML; `sweetspot init` lists the cells that it can write".into()
            }
            Self::Stl | Self::Obj => mesh.into(),
            Self::Dxf => {
                "to use it as a floor plan, add this key to an obstacle: plan = { file = \"NAME.dxf\", layers = [\"LAYER\"], height_mm = 3000 }".into()
            }
            Self::Json => "give the cell file, or the result folder: sweetspot report FOLDER".into(),
            Self::Yaml => format!("for a Universal Robots calibration: sweetspot calibrate ROBOT {path}"),
            Self::DataTable => {
                format!(
                    "for measured positions: sweetspot calibrate ROBOT {path}; for targets: sweetspot correct CELL --targets {path}"
                )
            }
        }
    }
}

/// Returns the command that converts the COLLADA mesh or the STEP model at `path` to STL.
pub fn conversion(path: &str) -> String {
    let quote = if path.ends_with('\'') { "'" } else { "" };
    let name = path.trim_end_matches('\'');
    let (stem, ending) = name.rsplit_once('.').unwrap_or((name, ""));
    match ending.to_ascii_lowercase().as_str() {
        "step" | "stp" => format!("gmsh {path} -2 -format stl -o {stem}.stl{quote}"),
        _ => format!("assimp export {path} {stem}.stl{quote}"),
    }
}

/// Returns the message for a file that is not of the needed kind.
pub fn not_needed(path: &str, kind: FileContent, needed: &str) -> String {
    format!("`{}` is {}, not {needed}", shown(path), kind.in_words())
}

fn of_xml(text: &str, bytes: &[u8]) -> FileContent {
    let mut rest = text;
    // Declarations and comments precede the root element.
    while let Some(start) = rest.find('<') {
        rest = &rest[start..];
        if let Some(comment) = rest.strip_prefix("<!--") {
            rest = comment.split_once("-->").map_or("", |(_, after)| after);
        } else if rest.starts_with("<?") || rest.starts_with("<!") {
            rest = rest.split_once('>').map_or("", |(_, after)| after);
        } else {
            break;
        }
    }
    let name: String =
        rest.chars().skip(1).take_while(|c| !c.is_whitespace() && !"/>".contains(*c)).collect();
    match name.as_str() {
        "robot" if has_macros(&String::from_utf8_lossy(bytes)) => FileContent::Xacro,
        "robot" => FileContent::Urdf,
        "COLLADA" => FileContent::Collada,
        _ => FileContent::OtherXml,
    }
}

/// Returns whether a robot description contains xacro elements or substitutions.
fn has_macros(text: &str) -> bool {
    ["<xacro:", "\"${", "\"$("].iter().any(|word| text.contains(word))
}

/// Returns whether the size of a file fits the number of triangles that a binary STL states after its header.
fn is_binary_stl(bytes: &[u8]) -> bool {
    let Some(count) = bytes.get(80..84).and_then(|b| b.try_into().ok()).map(u32::from_le_bytes) else {
        return false;
    };
    count > 0 && bytes.len() as u64 == 84 + 50 * u64::from(count)
}

fn is_obj(lines: &[&str]) -> bool {
    let words = ["v", "vn", "vt", "f", "o", "g", "s", "l", "mtllib", "usemtl"];
    let first = |line: &&str| line.split_whitespace().next().is_some_and(|word| words.contains(&word));
    lines.iter().all(first) && lines.iter().any(|line| line.starts_with("v "))
}

fn is_yaml(lines: &[&str]) -> bool {
    let is_entry = |line: &&&str| {
        let key = line
            .trim_start_matches("- ")
            .split_once(':')
            .filter(|(_, rest)| rest.is_empty() || rest.starts_with(' '));
        key.is_some_and(|(key, _)| {
            !key.is_empty() && key.chars().all(|c| c.is_alphanumeric() || "_-".contains(c))
        })
    };
    let lines: Vec<_> = lines.iter().copied().filter(|line| *line != "---").collect();
    lines.len() > 1 && lines.iter().filter(|line| is_entry(line)).count() * 2 > lines.len()
}

/// Returns whether all lines have the same number of values, separated by commas, semicolons or tabs.
fn is_table(lines: &[&str]) -> bool {
    [',', ';', '\t'].iter().any(|separator| {
        let count = |line: &&str| line.matches(*separator).count();
        let first = lines.first().map_or(0, count);
        first > 0 && lines.len() > 1 && lines.iter().all(|line| count(line) == first)
    })
}
