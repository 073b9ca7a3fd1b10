//! Tests texts in DXF files.

use sweetspot::report::dxf::text::safe;

#[test]
fn no_name_in_a_dxf_is_a_command() {
    let cases = [
        ("table", "table"),
        ("a\r\n  0\r\nEOF", "a/r/n  0/r/nEOF"),
        ("%%c 50%%%", "% %c 50% % %"),
        ("caret ^J", "caret ^ J"),
        ("\\P \\U+0041", "/P /U+0041"),
        ("T\u{fc}r \u{1f916}", "T\\U+00FCr ?"),
        ("\u{1b}[2J\u{0}", "/u{1b}[2J/u{0}"),
        ("\u{202e}x", "/u{202e}x"),
    ];
    // Only the signs of degrees and of plus or minus are codes.
    assert_eq!(safe("10\u{b0} \u{b1}2 %%p"), "10%%d %%p2 % %p");
    for (name, written) in cases {
        assert_eq!(safe(name), written);
        assert!(!safe(name).contains("%%") && safe(name).is_ascii());
    }
}
