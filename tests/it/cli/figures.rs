//! Tests the command `figures`.

use crate::cli::sandbox::*;

/// The figures of the paper's cell state the same values as the paper and `results/discrepancy`.
#[test]
fn one_command_draws_the_figures_of_the_paper() {
    let shop = Sandbox::new();
    shop.done(&["figures", PAPER, "--out", "pictures", "--width", "400"]);
    let folder = shop.path("pictures");
    let names = ["01-cell", "04-x", "04-y", "04-z", "05-resultant", "06-in-plane"];
    for name in names {
        let bytes = std::fs::read(folder.join(format!("{name}.png"))).unwrap();
        let mut reader = png::Decoder::new(std::io::Cursor::new(bytes)).read_info().unwrap();
        let mut pixels = vec![0; reader.output_buffer_size().unwrap()];
        let info = reader.next_frame(&mut pixels).unwrap();
        assert_eq!((info.width, info.height), (400, 250), "{name}");
    }
    let text = std::fs::read_to_string(folder.join("README.md")).unwrap();
    for said in [
        "80 of 99 nodes",
        "from 3.769 mm",
        "resultant 0.190 %",
        "(above 1 % at 5)",
        "y 0.355 %, z 0.317 %",
        "sweetspot figures",
    ] {
        assert!(text.contains(said), "{said} not in {text}");
    }
    names.iter().for_each(|name| assert!(text.contains(&format!("({name}.png)")), "{name}"));
    assert!(folder.join("08-discrepancy.svg").is_file() && folder.join("manifest.json").is_file());
    // A cell with one operation has no figure of all operations.
    assert!(!folder.join("07-all.png").exists());
    // Existing files are not overwritten.
    assert_eq!(shop.run(&["figures", PAPER, "--out", "pictures"]).code, Some(2));
}
