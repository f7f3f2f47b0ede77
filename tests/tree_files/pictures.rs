//! Pictures.

use super::*;

const TREE: &str = "<ReactiveFallback><Inverter><L name=\"door\" s=\"F\"/></Inverter><Timeout msec=\"5\"><L name=\"go\" s=\"R\"/></Timeout></ReactiveFallback>";

#[test]
fn a_tree_is_shown_as_indented_text_with_its_counts() {
    let expected = "\
Main: 5 nodes, 3 levels
ReactiveFallback
├─ Inverter
│  └─ L 'door' s=F
└─ Timeout msec=5
   └─ L 'go' s=R

Inverter              1
L                     2
ReactiveFallback      1
Timeout               1

by class  Action 2, Control 1, Decorator 2
by level  1 2 2
";
    assert_eq!(instance(&file(TREE)).outline(), expected);
}

#[test]
fn a_graph_has_a_line_for_each_node_and_edge() {
    let graph = instance(&file(TREE)).dot();
    assert!(graph.starts_with("digraph \"Main\" {"), "{graph}");
    assert_eq!((graph.matches("label=").count(), graph.matches(" -> ").count()), (5, 4));
}
