use crate::*;
#[test]
fn demo_loads() {
    let text = include_str!("../../../scenes/demo.toml");
    let files = |path: &str| Ok(format!("text of {path}"));
    let scene = Scene::load(text, "scenes/demo.toml", &[], None, &files).unwrap();
    assert_eq!(carton_layout(&scene, scene.streams()).len(), 48);
}
