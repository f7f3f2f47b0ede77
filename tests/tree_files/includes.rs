//! Files that include others.

use super::*;

fn load(files: &[(&str, &str)]) -> Result<Document, LoadError> {
    let files: BTreeMap<PathBuf, String> =
        files.iter().map(|(path, text)| (PathBuf::from(path), (*text).to_owned())).collect();
    let read = |path: &Path| files.get(path).cloned().ok_or_else(|| io::Error::other("no such file"));
    Document::load(Path::new("d/main.xml"), &read, &Extras::default())
}

const MAIN: &str = "<root BTCPP_format=\"4\" main_tree_to_execute=\"Main\"><include path=\"lib/a.xml\"/>
<BehaviorTree ID=\"Main\"><SubTree ID=\"A\"/></BehaviorTree></root>";
const A: &str = "<root BTCPP_format=\"4\"><BehaviorTree ID=\"A\"><Wait/></BehaviorTree>
<TreeNodesModel><Action ID=\"Wait\"/></TreeNodesModel></root>";

#[test]
fn trees_and_models_come_from_files_relative_to_the_including_one() {
    let document = load(&[("d/main.xml", MAIN), ("d/lib/a.xml", A)]).unwrap();
    assert_eq!(tree::check(&document, None), []);
    let instance = Instance::of(&document, "Main").unwrap();
    assert_eq!(dry_run(&instance, 1, &[("Wait", "F")]).text, "tick 1: Wait:F => FAILURE\n");
    assert!(document.export().contains("<BehaviorTree ID=\"A\">"), "one file has it all");
}

#[test]
fn what_cannot_be_included_is_named_where_it_is_included() {
    let refusal = |files: &[(&str, &str)]| load(files).err().map(|error| error.to_string());
    let missing = "d/main.xml:1:61: error: cannot include 'd/lib/a.xml': no such file";
    assert_eq!(refusal(&[("d/main.xml", MAIN)]).as_deref(), Some(missing));
    let circle = "<root><include path=\"../main.xml\"/></root>";
    let expected = "d/lib/a.xml:1:16: error: 'd/lib/../main.xml' includes itself";
    assert_eq!(refusal(&[("d/main.xml", MAIN), ("d/lib/a.xml", circle)]).as_deref(), Some(expected));
    let nameless = "<root><include file=\"a\"/></root>";
    let expected = "d/main.xml:1:7: error: <include> has no attribute 'path'";
    assert_eq!(refusal(&[("d/main.xml", nameless)]).as_deref(), Some(expected));
    let packaged = "<root><include ros_pkg=\"p\" path=\"a\"/></root>";
    let expected =
        "d/main.xml:1:16: error: ROS packages are not known here: write 'path' relative to this file";
    assert_eq!(refusal(&[("d/main.xml", packaged)]).as_deref(), Some(expected));
    assert_eq!(refusal(&[]).as_deref(), Some("d/main.xml: no such file"));
}

#[test]
fn errors_in_an_included_file_name_that_file() {
    let document =
        load(&[("d/main.xml", MAIN), ("d/lib/a.xml", &A.replace("<Wait/>", "\n<Wait x=\"1\"/>"))]).unwrap();
    let expected = "d/lib/a.xml:2:7: error: Wait has no port 'x': it has none";
    assert_eq!(
        tree::check(&document, None).iter().map(Diagnostic::to_string).collect::<Vec<_>>(),
        [expected]
    );
}
