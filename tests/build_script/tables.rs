//! Tables with mistakes: each is named with its file and line.

use crate::load::table;

const FILE: &str = "models/tables/two-words.toml";

/// A table without mistakes. Its first line is line 1.
const GOOD: &str = r#"# A comment.
schema = 1
name = "two-words"
kind = "force"
description = "what it is"
equation = "d_f = k f"
source = "nowhere"
sympy = "1.14.0"

[parameters]
unit = "m"
components = ["x", "y"]

[inputs]
f_x = "force.x"
w_y = "rate.y"

[constants]
g = 9.8

[jacobian]
rows = 6
columns = 2
nonzeros = 2
operations = { add = 1, multiply = 2, divide = 1, function = 0 }
steps = [
  { name = "x0", expr = "f_x/g" },
]
entries = [
  { row = 3, column = 0, expr = "x0**2" },
  { row = 5, column = 1, expr = "2*w_y + x0" },
]
"#;

#[test]
fn a_good_table_is_understood() {
    let table = table(FILE, GOOD).unwrap();
    assert_eq!((table.rows, table.columns, table.entries.len(), table.steps.len()), (6, 2, 2, 1));
    assert_eq!(table.inputs.len(), 2);
    assert_eq!(table.constants, [("g".to_owned(), 9.8)]);
}

#[test]
fn every_committed_table_is_understood() {
    let mut count = 0;
    for entry in std::fs::read_dir("models/tables").unwrap() {
        let path = entry.unwrap().path();
        let text = std::fs::read_to_string(&path).unwrap();
        table(path.to_str().unwrap(), &text).unwrap();
        count += 1;
    }
    assert!(count >= 31, "{count} tables");
}

#[test]
fn mistakes_are_named_with_file_and_line() {
    for (from, to, line, message) in [
        ("schema = 1", "schema = 2", 2, "schema 2 is not 1"),
        ("schema = 1", "schema = one", 2, ""),
        ("schema = 1\n", "", 1, "missing field `schema`"),
        ("\"two-words\"", "\"Two Words\"", 3, "`Two Words` is not a name"),
        ("\"force\"", "\"farce\"", 4, "kind `farce` is not one of rate, force"),
        ("\"what it is\"", "\" \"", 5, "must say something"),
        ("sympy = \"1.14.0\"", "sympy = \"1.14.0\"\nmood = 3", 9, "unknown field `mood`"),
        ("[\"x\", \"y\"]", "[\"x\", \"x\"]", 12, "component `x`"),
        ("[\"x\", \"y\"]", "[\"x\"]", 23, "columns says 2, this kind of table has 1"),
        ("\"force.x\"", "\"force.q\"", 15, "`force.q` is not a field of `Signals`"),
        ("\"force.x\"", "\"velocity.x\"", 15, "`velocity.x` is not a field of `Signals`"),
        ("w_y = ", "fn = ", 16, "`fn` is not a name"),
        ("w_y = \"rate.y\"", "w_y = \"rate.y\"\nw_z = \"rate.z\"", 17, "`w_z` is never used"),
        ("g = 9.8", "g = inf", 19, "`g` is not finite"),
        ("g = 9.8", "f_x = 9.8\ng = 9.8", 19, "`f_x` is defined twice"),
        ("rows = 6", "rows = 9", 22, "rows says 9, this kind of table has 6"),
        ("nonzeros = 2", "nonzeros = 3", 24, "nonzeros says 3, there are 2 entries"),
        ("multiply = 2", "multiply = 3", 25, "counted are 1 additions, 2 multiplications"),
        ("f_x/g", "f_x/h", 27, "`h` is no input, constant or earlier step"),
        ("f_x/g", "f_x/", 27, "the expression ends too early"),
        ("\"x0\", expr", "\"g\", expr", 27, "`g` is defined twice"),
        ("\"x0**2\"", "\"x0**x\"", 30, "integer exponent"),
        ("\"x0**2\"", "\"x0**2 f_x\"", 30, "expected an operator"),
        ("row = 3", "row = 6", 30, "row 6 is outside rows 3 to 5"),
        ("row = 3", "row = 2", 30, "row 2 is outside rows 3 to 5"),
        ("column = 1", "column = 2", 31, "column 2 is outside 2 columns"),
        ("row = 5, column = 1", "row = 3, column = 0", 31, "entry (3, 0) stands here twice"),
        ("row = 5, column = 1", "row = 5, column = -1", 31, ""),
        ("row = 5, column = 1", "row = 5", 31, "missing field `column`"),
        ("expr = \"x0**2\" }", "expr = x0 }", 30, ""),
    ] {
        assert_eq!(GOOD.matches(from).count(), 1, "{from} must stand once in the good table");
        let error = table(FILE, &GOOD.replace(from, to)).expect_err(to);
        assert!(error.starts_with(&format!("{FILE}:{line}: ")), "{to}: line {line} expected: {error}");
        assert!(error.contains(message), "{to}: {error}");
    }
}

#[test]
fn a_table_stands_in_the_file_of_its_name() {
    assert!(table("models/tables/other.toml", GOOD).unwrap_err().contains("`two-words`"));
}

#[test]
fn a_column_at_a_time_has_no_steps() {
    let table = table(
        FILE,
        &GOOD
            .replace("\"force\"", "\"injection\"")
            .replace("[parameters]\nunit = \"m\"\ncomponents = [\"x\", \"y\"]\n", "")
            .replace("force.x", "force_n.x")
            .replace("rate.y", "rate_eb.y")
            .replace("rows = 6\ncolumns = 2", "rows = 9\ncolumns = 6"),
    );
    let error = table.unwrap_err();
    assert!(error.contains("asked for by column has no steps"), "{error}");
}
