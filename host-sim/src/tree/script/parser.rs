//! The parser of scripts.

use super::{Assignment, Binary, ComparisonOperator, Expression, Prefix, Scalar};
use winnow::ascii::{digit1, hex_digit1};
use winnow::combinator::{
    Infix, alt, cut_err, delimited, eof, expression, fail, not, opt, preceded, repeat, repeat_till,
    terminated,
};
use winnow::error::{ContextError, ErrMode, StrContext, StrContextValue};
use winnow::prelude::*;
use winnow::stream::Stateful;
use winnow::token::{one_of, take_till, take_while};

/// The deepest nesting of expressions that is read.
const MAX_DEPTH: usize = 100;

/// The most operators of a script.
const MAX_OPERATORS: usize = 1000;

/// The rest of the text, with the depth and the operators so far.
type ScriptInput<'t> = Stateful<&'t str, Met>;

#[derive(Debug, Default)]
struct Met {
    depth: usize,
    operators: usize,
}

/// The statements of a script.
///
/// # Errors
/// What is wrong and at which character.
pub(super) fn statements(text: &str) -> Result<Vec<Expression>, String> {
    let ends = repeat::<_, _, (), _, _>(0.., word(";"));
    let script = repeat_till(0.., terminated(statement, ends), (blanks, eof));
    let input = Stateful { input: text, state: Met::default() };
    script
        .map(|(statements, _)| statements)
        .parse(input)
        .map_err(|error| reason(text, error.offset(), error.inner()))
}

/// The innermost thing that was expected, and what was found in its place.
fn reason(text: &str, at: usize, error: &ContextError) -> String {
    let rest = text.get(at..).unwrap_or_default().trim_start();
    let place = 1 + text.chars().count() - rest.chars().count();
    let is_part = |sign: char| sign.is_alphanumeric() || matches!(sign, '_' | '@' | '.');
    let word = rest.split(|sign| !is_part(sign)).next().unwrap_or_default();
    let first = rest.chars().next().map_or(0, char::len_utf8);
    let found = &rest[..word.len().max(first)];
    match error.context().next() {
        Some(StrContext::Label(label)) => format!("{label}, at character {place}"),
        Some(StrContext::Expected(wanted)) if found.is_empty() => format!("expected {wanted} at the end"),
        Some(StrContext::Expected(wanted)) => {
            format!("expected {wanted}, found '{found}' at character {place}")
        }
        _ => format!("a script has no '{found}' at character {place}"),
    }
}

fn expected(what: &'static str) -> StrContext {
    StrContext::Expected(StrContextValue::Description(what))
}

/// Refuses what was just read.
fn refused<T>(label: &'static str, input: &mut ScriptInput<'_>) -> ModalResult<T> {
    cut_err(fail).context(StrContext::Label(label)).parse_next(input)
}

/// An assignment, or a choice.
fn statement(input: &mut ScriptInput<'_>) -> ModalResult<Expression> {
    nested(
        |input| {
            let first = logic(input)?;
            let start = input.checkpoint();
            let kind = opt(sign.verify_map(assignment)).parse_next(input)?;
            match (kind, first) {
                (None, condition) => choice(condition, input),
                (Some(kind), Expression::Name(name)) => {
                    Ok(Expression::Assignment(kind, name, Box::new(statement(input)?)))
                }
                (Some(_), _) => {
                    input.reset(&start);
                    refused("only a variable can be assigned to", input)
                }
            }
        },
        input,
    )
}

/// A conditional expression, or its condition alone.
fn choice(condition: Expression, input: &mut ScriptInput<'_>) -> ModalResult<Expression> {
    if opt(word("?")).parse_next(input)?.is_none() {
        return Ok(condition);
    }
    let then = statement(input)?;
    cut_err(word(":")).context(expected("':'")).parse_next(input)?;
    let otherwise = nested(|input| logic(input).and_then(|condition| choice(condition, input)), input)?;
    Ok(Expression::Choice(Box::new([condition, then, otherwise])))
}

/// Conjunctions and disjunctions of comparisons.
fn logic(input: &mut ScriptInput<'_>) -> ModalResult<Expression> {
    let infix = sign.verify_map(|sign| {
        Some(match sign {
            "||" => Infix::Left(1, |input, a, b| binary(Binary::Or, a, b, input)),
            "&&" => Infix::Left(2, |input, a, b| binary(Binary::And, a, b, input)),
            _ => return None,
        })
    });
    expression(comparison).prefix(fail).infix(infix).parse_next(input)
}

/// A value and all that it is compared with.
fn comparison(input: &mut ScriptInput<'_>) -> ModalResult<Expression> {
    let first = arithmetic(input)?;
    let others: Vec<_> = repeat(0.., (sign.verify_map(comparison_sign), arithmetic)).parse_next(input)?;
    Ok(if others.is_empty() { first } else { Expression::ComparisonOperator(Box::new(first), others) })
}

/// Sums and products of values.
fn arithmetic(input: &mut ScriptInput<'_>) -> ModalResult<Expression> {
    let infix = sign.verify_map(|sign| {
        Some(match sign {
            "|" => Infix::Left(1, |input, a, b| binary(Binary::BitOr, a, b, input)),
            "^" => Infix::Left(1, |input, a, b| binary(Binary::BitXor, a, b, input)),
            "&" => Infix::Left(2, |input, a, b| binary(Binary::BitAnd, a, b, input)),
            "+" => Infix::Left(3, |input, a, b| binary(Binary::Add, a, b, input)),
            "-" => Infix::Left(3, |input, a, b| binary(Binary::Subtract, a, b, input)),
            ".." => Infix::Left(3, |input, a, b| binary(Binary::Concatenate, a, b, input)),
            "*" => Infix::Left(4, |input, a, b| binary(Binary::Multiply, a, b, input)),
            "/" => Infix::Left(4, |input, a, b| binary(Binary::Divide, a, b, input)),
            _ => return None,
        })
    });
    expression(operand).prefix(fail).infix(infix).parse_next(input)
}

fn binary(
    operator: Binary,
    left: Expression,
    right: Expression,
    input: &mut ScriptInput<'_>,
) -> ModalResult<Expression> {
    input.state.operators += 1;
    if input.state.operators > MAX_OPERATORS {
        return refused("more than 1000 operators", input);
    }
    Ok(Expression::Binary(operator, Box::new(left), Box::new(right)))
}

/// A value, or a sign before one.
fn operand(input: &mut ScriptInput<'_>) -> ModalResult<Expression> {
    if let Some(prefix) = opt(sign.verify_map(prefix)).parse_next(input)? {
        return Ok(Expression::Prefix(prefix, Box::new(nested(operand, input)?)));
    }
    let inner = delimited(word("("), statement, cut_err(word(")")).context(expected("')'")));
    let value = alt((inner, text, number, name));
    cut_err(preceded(blanks, value)).context(expected("a value")).parse_next(input)
}

fn text(input: &mut ScriptInput<'_>) -> ModalResult<Expression> {
    let end = cut_err("'").context(expected("a closing quote"));
    let text = delimited("'", take_till(0.., '\''), end);
    text.map(|text: &str| Expression::Literal(Scalar::Text(text.to_owned()))).parse_next(input)
}

fn number(input: &mut ScriptInput<'_>) -> ModalResult<Expression> {
    let hexadecimal = preceded(alt(("0x", "0X")), hex_digit1)
        .verify_map(|digits| i64::from_str_radix(digits, 16).ok().map(Scalar::Integer));
    let fraction = preceded(('.', not('.')), digit1);
    let exponent = preceded((one_of(['e', 'E']), opt(one_of(['+', '-']))), digit1);
    let decimal = (digit1, opt(fraction), opt(exponent)).take().verify_map(|word: &str| {
        let is_whole = word.bytes().all(|digit| digit.is_ascii_digit());
        if is_whole { word.parse().ok().map(Scalar::Integer) } else { word.parse().ok().map(Scalar::Real) }
    });
    let end = not(one_of(|sign: char| is_part_of_name(sign) || sign == '@'));
    let number = terminated(alt((hexadecimal, decimal)), end);
    number.map(Expression::Literal).parse_next(input)
}

/// A variable, or a truth value.
fn name(input: &mut ScriptInput<'_>) -> ModalResult<Expression> {
    let first = one_of(|sign: char| sign.is_ascii_alphabetic() || matches!(sign, '_' | '@'));
    let name = (first, take_while(0.., is_part_of_name)).take();
    let mut value = name.map(|name: &str| match name {
        "true" => Expression::Literal(true.into()),
        "false" => Expression::Literal(false.into()),
        name => Expression::Name(name.to_owned()),
    });
    value.parse_next(input)
}

fn is_part_of_name(sign: char) -> bool {
    sign.is_ascii_alphanumeric() || sign == '_'
}

/// Reads with `read`, one level deeper.
fn nested(
    mut read: impl FnMut(&mut ScriptInput<'_>) -> ModalResult<Expression>,
    input: &mut ScriptInput<'_>,
) -> ModalResult<Expression> {
    input.state.depth += 1;
    if input.state.depth > MAX_DEPTH {
        return refused("more than 100 expressions in each other", input);
    }
    let inner = read(input)?;
    input.state.depth -= 1;
    Ok(inner)
}

fn blanks<'t>(input: &mut ScriptInput<'t>) -> ModalResult<&'t str> {
    take_while(0.., [' ', '\t', '\n', '\r']).parse_next(input)
}

/// The next sign, the longest that there is.
fn sign<'t>(input: &mut ScriptInput<'t>) -> ModalResult<&'t str> {
    let pairs = alt(["..", "&&", "||", "==", "!=", "<=", ">=", ":=", "+=", "-=", "*=", "/="]);
    let single = one_of(|sign| "+-*/&|^~!<>=?:();".contains(sign)).take();
    preceded(blanks, alt((pairs, single))).parse_next(input)
}

/// Reads a given sign.
fn word<'t>(wanted: &'static str) -> impl Parser<ScriptInput<'t>, &'t str, ErrMode<ContextError>> {
    sign.verify(move |sign: &str| sign == wanted)
}

fn prefix(sign: &str) -> Option<Prefix> {
    Some(match sign {
        "-" => Prefix::Minus,
        "~" => Prefix::Complement,
        "!" => Prefix::Not,
        _ => return None,
    })
}

fn comparison_sign(sign: &str) -> Option<ComparisonOperator> {
    Some(match sign {
        "==" => ComparisonOperator::Equal,
        "!=" => ComparisonOperator::Unequal,
        "<" => ComparisonOperator::Less,
        ">" => ComparisonOperator::Greater,
        "<=" => ComparisonOperator::LessOrEqual,
        ">=" => ComparisonOperator::GreaterOrEqual,
        _ => return None,
    })
}

fn assignment(sign: &str) -> Option<Assignment> {
    Some(match sign {
        ":=" => Assignment::Create,
        "=" => Assignment::Set,
        "+=" => Assignment::Change(Binary::Add),
        "-=" => Assignment::Change(Binary::Subtract),
        "*=" => Assignment::Change(Binary::Multiply),
        "/=" => Assignment::Change(Binary::Divide),
        _ => return None,
    })
}
