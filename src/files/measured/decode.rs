//! Decoder of data files: UTF-8, UTF-16 and ISO 8859-1.

/// Decodes a data file, and removes the byte order mark.
///
/// A byte order mark, or a zero in every second byte, identifies UTF-16. If a file is neither UTF-16 nor
/// UTF-8, each byte is one character (ISO 8859-1). Old spreadsheets use the encoding Windows-1252, not ISO
/// 8859-1. Both encodings represent the degree sign and the umlauts by the same bytes.
///
/// # Errors
///
/// Returns why the bytes are not text.
pub fn decode(bytes: &[u8]) -> Result<String, String> {
    let text = match bytes {
        [0xff, 0xfe, rest @ ..] => utf_16(rest, u16::from_le_bytes)?,
        [0xfe, 0xff, rest @ ..] => utf_16(rest, u16::from_be_bytes)?,
        [first, 0, second, 0, ..] if *first > 0 && *second > 0 => utf_16(bytes, u16::from_le_bytes)?,
        [0, first, 0, second, ..] if *first > 0 && *second > 0 => utf_16(bytes, u16::from_be_bytes)?,
        _ => match std::str::from_utf8(bytes) {
            Ok(text) => text.to_string(),
            Err(_) => bytes.iter().map(|byte| char::from(*byte)).collect(),
        },
    };
    if text.contains('\0') {
        return Err("the file is not text".into());
    }
    Ok(text.strip_prefix('\u{feff}').map(str::to_string).unwrap_or(text))
}

fn utf_16(bytes: &[u8], unit: fn([u8; 2]) -> u16) -> Result<String, String> {
    let units = bytes.chunks_exact(2).map(|pair| unit([pair[0], pair[1]]));
    char::decode_utf16(units).collect::<Result<String, _>>().map_err(|_| "the file is damaged UTF-16".into())
}
