//! From words to expressions.

use super::token::{Kind, Token, tokens};
use super::{Assignment, Binary, Comparison, Expression, Prefix, Scalar};

/// The deepest nesting of expressions that is read.
const MAX_DEPTH: usize = 100;

/// The most operators of a script.
const MAX_OPERATORS: usize = 1000;

pub(super) fn statements(text: &str) -> Result<Vec<Expression>, String> {
    let mut parser = Parser { text, tokens: tokens(text), at: 0, depth: 0, operators: 0 };
    let mut statements = Vec::new();
    while parser.peek().kind != Kind::End {
        statements.push(parser.expression(0)?);
        while parser.takes(";") {}
    }
    Ok(statements)
}

struct Parser<'t> {
    text: &'t str,
    tokens: Vec<Token<'t>>,
    at: usize,
    depth: usize,
    operators: usize,
}

const ASSIGNMENT: u8 = 2;
const CHOICE: u8 = 4;
const COMPARISON: u8 = 10;
const PREFIX: u8 = 20;

impl<'t> Parser<'t> {
    fn peek(&self) -> Token<'t> {
        let end = Token { kind: Kind::End, text: "", at: self.text.len() };
        self.tokens.get(self.at).copied().unwrap_or(end)
    }

    fn next(&mut self) -> Token<'t> {
        let token = self.peek();
        self.at += 1;
        token
    }

    fn takes(&mut self, operator: &str) -> bool {
        let token = self.peek();
        let is_next = token.kind == Kind::Operator && token.text == operator;
        self.at += usize::from(is_next);
        is_next
    }

    fn expect(&mut self, operator: &str) -> Result<(), String> {
        if self.takes(operator) { Ok(()) } else { Err(self.expected(&format!("'{operator}'"))) }
    }

    fn expected(&self, what: &str) -> String {
        let token = self.peek();
        match token.kind {
            Kind::End => format!("expected {what} at the end"),
            Kind::Wrong => self.wrong(token),
            _ => format!("expected {what}, found '{}' {}", token.text, self.place(token)),
        }
    }

    fn wrong(&self, token: Token<'_>) -> String {
        format!("'{}' {} is nothing that a script knows", token.text, self.place(token))
    }

    fn place(&self, token: Token<'_>) -> String {
        format!("at character {}", 1 + self.text.get(..token.at).unwrap_or_default().chars().count())
    }

    /// Reads what binds at least as tightly as `least`.
    fn expression(&mut self, least: u8) -> Result<Expression, String> {
        self.depth += 1;
        if self.depth > MAX_DEPTH {
            return Err(format!("more than {MAX_DEPTH} expressions in each other"));
        }
        let mut left = self.operand()?;
        loop {
            let token = self.peek();
            if token.kind == Kind::Wrong {
                return Err(self.wrong(token));
            }
            let Some(power) = power(token).filter(|power| *power >= least) else { break };
            self.operators += 1;
            if self.operators > MAX_OPERATORS {
                return Err(format!("more than {MAX_OPERATORS} operators"));
            }
            left = match power {
                ASSIGNMENT => self.assignment(left)?,
                CHOICE => self.choice(left)?,
                COMPARISON => self.comparison(left)?,
                _ => self.binary(left, power)?,
            };
            if matches!(power, ASSIGNMENT | CHOICE) {
                break;
            }
        }
        self.depth -= 1;
        Ok(left)
    }

    fn operand(&mut self) -> Result<Expression, String> {
        let token = self.peek();
        match token.kind {
            Kind::Integer | Kind::Real | Kind::Text | Kind::Truth => {
                self.next();
                let literal = literal(token).ok_or_else(|| self.wrong(token))?;
                Ok(Expression::Literal(literal))
            }
            Kind::Name => Ok(Expression::Name(self.next().text.to_owned())),
            Kind::Operator if token.text == "(" => {
                self.next();
                let inner = self.expression(0)?;
                self.expect(")")?;
                Ok(inner)
            }
            _ => {
                let prefix = match token.text {
                    "-" => Prefix::Minus,
                    "~" => Prefix::Complement,
                    "!" => Prefix::Not,
                    _ => return Err(self.expected("a value")),
                };
                self.next();
                Ok(Expression::Prefix(prefix, Box::new(self.expression(PREFIX)?)))
            }
        }
    }

    fn assignment(&mut self, target: Expression) -> Result<Expression, String> {
        let token = self.next();
        let Expression::Name(name) = target else {
            return Err(format!("only a variable can be assigned to, {}", self.place(token)));
        };
        let kind = match token.text {
            ":=" => Assignment::Create,
            "+=" => Assignment::Change(Binary::Add),
            "-=" => Assignment::Change(Binary::Subtract),
            "*=" => Assignment::Change(Binary::Multiply),
            "/=" => Assignment::Change(Binary::Divide),
            _ => Assignment::Set,
        };
        Ok(Expression::Assignment(kind, name, Box::new(self.expression(0)?)))
    }

    fn choice(&mut self, condition: Expression) -> Result<Expression, String> {
        self.next();
        let then = self.expression(0)?;
        self.expect(":")?;
        let otherwise = self.expression(CHOICE)?;
        Ok(Expression::Choice(Box::new([condition, then, otherwise])))
    }

    fn comparison(&mut self, first: Expression) -> Result<Expression, String> {
        let mut others = Vec::new();
        while let Some(comparison) = comparison(self.peek()) {
            self.next();
            others.push((comparison, self.expression(COMPARISON + 1)?));
        }
        Ok(Expression::Comparison(Box::new(first), others))
    }

    fn binary(&mut self, left: Expression, power: u8) -> Result<Expression, String> {
        let token = self.next();
        let binary = match token.text {
            "||" => Binary::Or,
            "&&" => Binary::And,
            "|" => Binary::BitOr,
            "^" => Binary::BitXor,
            "&" => Binary::BitAnd,
            "+" => Binary::Add,
            "-" => Binary::Subtract,
            ".." => Binary::Concatenate,
            "*" => Binary::Multiply,
            _ => Binary::Divide,
        };
        let right = self.expression(power + 1)?;
        Ok(Expression::Binary(binary, Box::new(left), Box::new(right)))
    }
}

/// How tightly an operator between two operands binds them.
fn power(token: Token<'_>) -> Option<u8> {
    if token.kind != Kind::Operator {
        return None;
    }
    Some(match token.text {
        ":=" | "=" | "+=" | "-=" | "*=" | "/=" => ASSIGNMENT,
        "?" => CHOICE,
        "||" => 6,
        "&&" => 8,
        "==" | "!=" | "<" | ">" | "<=" | ">=" => COMPARISON,
        "|" | "^" => 12,
        "&" => 14,
        "+" | "-" | ".." => 16,
        "*" | "/" => 18,
        _ => return None,
    })
}

fn comparison(token: Token<'_>) -> Option<Comparison> {
    Some(match (token.kind, token.text) {
        (Kind::Operator, "==") => Comparison::Equal,
        (Kind::Operator, "!=") => Comparison::Unequal,
        (Kind::Operator, "<") => Comparison::Less,
        (Kind::Operator, ">") => Comparison::Greater,
        (Kind::Operator, "<=") => Comparison::LessOrEqual,
        (Kind::Operator, ">=") => Comparison::GreaterOrEqual,
        _ => return None,
    })
}

fn literal(token: Token<'_>) -> Option<Scalar> {
    let text = token.text;
    Some(match token.kind {
        Kind::Text => Scalar::Text(text.trim_matches('\'').to_owned()),
        Kind::Truth => Scalar::Real(if text == "true" { 1.0 } else { 0.0 }),
        Kind::Real => Scalar::Real(text.parse().ok()?),
        _ => Scalar::Integer(match text.strip_prefix("0x").or_else(|| text.strip_prefix("0X")) {
            Some(digits) => i64::from_str_radix(digits, 16).ok()?,
            None => text.parse().ok()?,
        }),
    })
}
