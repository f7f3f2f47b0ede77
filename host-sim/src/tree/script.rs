//! BehaviorTree.CPP's scripts: small programs in the attributes of a tree file.
//!
//! ```text
//! script     = statement { ";" statement }
//! statement  = name (":=" | "=" | "+=" | "-=" | "*=" | "/=") expression | expression
//! expression = condition [ "?" expression ":" expression ]
//! ```
//! with, from loose to tight, `||`, `&&`, comparisons (which chain), `|` `^`, `&`, `+` `-` `..`,
//! `*` `/`, and `-` `~` `!` before a value. Values are numbers and text; truth is a number.

mod parser;
mod run;

pub(super) use run::{Scalar, Variables};

/// A script that was read.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Script {
    statements: Vec<Expression>,
}

#[derive(Clone, Debug, PartialEq)]
enum Expression {
    Literal(Scalar),
    Name(String),
    Prefix(Prefix, Box<Expression>),
    Binary(Binary, Box<Expression>, Box<Expression>),
    /// A first operand and what it is compared with, one after another.
    ComparisonOperator(Box<Expression>, Vec<(ComparisonOperator, Expression)>),
    Choice(Box<[Expression; 3]>),
    Assignment(Assignment, String, Box<Expression>),
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Prefix {
    Minus,
    Complement,
    Not,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Binary {
    Add,
    Subtract,
    Multiply,
    Divide,
    Concatenate,
    BitAnd,
    BitOr,
    BitXor,
    And,
    Or,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum ComparisonOperator {
    Equal,
    Unequal,
    Less,
    Greater,
    LessOrEqual,
    GreaterOrEqual,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Assignment {
    /// `:=`, which makes the variable if there is none.
    Create,
    /// `=`
    Set,
    /// `+=` and its like.
    Change(Binary),
}

impl Script {
    /// Reads a script.
    ///
    /// # Errors
    /// What is wrong and at which character.
    pub(super) fn read(text: &str) -> Result<Self, String> {
        let statements = parser::statements(text)?;
        if statements.is_empty() {
            return Err("the script is empty".into());
        }
        Ok(Self { statements })
    }

    /// Runs the script; its value is that of the last statement.
    ///
    /// # Errors
    /// What cannot be computed: an unknown variable, values that do not go together.
    pub(super) fn run(&self, variables: &mut dyn Variables) -> Result<Scalar, String> {
        run::statements(&self.statements, variables)
    }

    /// The variables that it writes.
    pub(super) fn writes(&self) -> Vec<&str> {
        let mut names = Vec::new();
        self.statements.iter().for_each(|statement| statement.collect_writes(&mut names));
        names
    }
}

impl Expression {
    fn collect_writes<'a>(&'a self, names: &mut Vec<&'a str>) {
        match self {
            Self::Literal(_) | Self::Name(_) => {}
            Self::Prefix(_, operand) => operand.collect_writes(names),
            Self::Binary(_, left, right) => {
                left.collect_writes(names);
                right.collect_writes(names);
            }
            Self::ComparisonOperator(first, others) => {
                first.collect_writes(names);
                others.iter().for_each(|(_, other)| other.collect_writes(names));
            }
            Self::Choice(parts) => parts.iter().for_each(|part| part.collect_writes(names)),
            Self::Assignment(_, name, value) => {
                names.push(name);
                value.collect_writes(names);
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;

    impl Variables for BTreeMap<String, Scalar> {
        fn value(&self, name: &str) -> Option<Scalar> {
            self.get(name).cloned()
        }

        fn set(&mut self, name: &str, value: Scalar) {
            self.insert(name.to_owned(), value);
        }
    }

    fn run(text: &str) -> Result<Scalar, String> {
        Script::read(text)?.run(&mut BTreeMap::new())
    }

    #[test]
    fn operators_bind_as_in_behavior_tree_cpp() {
        for (text, expected) in [
            ("1 + 2 * 3", 7.0),
            ("(1 + 2) * 3", 9.0),
            ("-2 * -3", 6.0),
            ("10 - 2 - 3", 5.0),
            ("7 / 2", 3.5),
            ("0x1F & 0x10 | 1", 17.0),
            ("6 ^ 3", 5.0),
            ("~0", -1.0),
            ("1 < 2 < 3", 1.0),
            ("1 < 3 < 2", 0.0),
            ("1 == 1 && 2 != 2 || true", 1.0),
            ("!false && !0", 1.0),
            ("2 > 1 ? 10 : 20", 10.0),
            ("0 ? 1 : 0 ? 2 : 3", 3.0),
            ("a := 3; a += 4; a *= 2; a", 14.0),
            ("a := 1; b := a = 5; a + b", 10.0),
            ("'x' == 'x'", 1.0),
            ("'a' < 'b'", 1.0),
            ("'3' == 3", 1.0),
            ("'true' == 1", 1.0),
            ("1e2 + .5 ", f64::NAN),
        ] {
            match run(text) {
                Ok(value) => assert_eq!(value.number(), Some(expected), "{text}"),
                Err(_) => assert!(expected.is_nan(), "{text}"),
            }
        }
        assert_eq!(run("'a' .. 'b' + 'c'"), Ok(Scalar::Text("abc".into())));
        assert_eq!(run("'n' .. 3"), Ok(Scalar::Text("n3".into())));
        assert_eq!(run("'x' .. 0.5"), Ok(Scalar::Text("x0.500000".into())));
    }

    #[test]
    fn a_script_that_cannot_be_read_is_refused_with_its_place() {
        for (text, expected) in [
            ("", "the script is empty"),
            ("1 +", "expected a value at the end"),
            ("(1", "expected ')' at the end"),
            ("a ? 1", "expected ':' at the end"),
            ("3foo", "expected a value, found '3foo' at character 1"),
            ("a + 1e", "expected a value, found '1e' at character 5"),
            ("9223372036854775808", "expected a value, found '9223372036854775808' at character 1"),
            ("a # b", "expected a value, found '#' at character 3"),
            ("'open", "expected a closing quote at the end"),
            ("1 := 2", "only a variable can be assigned to, at character 3"),
            ("a b ) ", "expected a value, found ')' at character 5"),
        ] {
            assert_eq!(Script::read(text).err().as_deref(), Some(expected), "{text}");
        }
        assert!(Script::read(&"(".repeat(100_000)).is_err());
        assert!(Script::read(&"-".repeat(100_000)).is_err());
        assert!(Script::read(&"a?".repeat(100_000)).is_err());
        assert!(Script::read(&"1+".repeat(100_000)).is_err());
    }

    #[test]
    fn what_cannot_be_computed_is_an_error() {
        for (text, expected) in [
            ("a", "there is no variable 'a'"),
            ("a = 1", "there is no variable 'a': ':=' makes one"),
            ("a += 1", "there is no variable 'a': ':=' makes one"),
            ("'a' - 'b'", "text cannot be an operand of '-'"),
            ("!'a'", "text cannot be negated"),
            ("1 .. 2", "'..' joins text, and neither operand is"),
            ("'a' < 1", "'a' is no number"),
            ("1 / 2 & 1", "0.5 is no whole number"),
        ] {
            assert_eq!(run(text).err().as_deref(), Some(expected), "{text}");
        }
    }

    #[test]
    fn it_is_known_what_a_script_writes() {
        let script = Script::read("a := b; c = (d += 1) > 2 ? e := 1 : f").unwrap();
        assert_eq!(script.writes(), ["a", "c", "d", "e"]);
    }
}
