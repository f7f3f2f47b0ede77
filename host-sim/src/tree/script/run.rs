//! The evaluation of scripts.

use super::{Assignment, Binary, ComparisonOperator, Expression, Prefix};

/// A value of a script.
#[derive(Clone, Debug, PartialEq)]
pub(in crate::tree) enum Scalar {
    Integer(i64),
    Real(f64),
    Text(String),
}

/// The variables of a script.
pub(in crate::tree) trait Variables {
    fn value(&self, name: &str) -> Option<Scalar>;
    fn set(&mut self, name: &str, value: Scalar);
}

impl Scalar {
    /// The number, if it is one.
    pub(in crate::tree) fn number(&self) -> Option<f64> {
        match self {
            Self::Integer(value) => Some(*value as f64),
            Self::Real(value) => Some(*value),
            Self::Text(_) => None,
        }
    }

    /// Whether it counts as true.
    ///
    /// # Errors
    /// For text that is neither a truth value nor a number.
    pub(in crate::tree) fn truth(&self) -> Result<bool, String> {
        Ok(self.as_number()? != 0.0)
    }

    /// The number, or the number that the text stands for.
    fn as_number(&self) -> Result<f64, String> {
        match self {
            Self::Text(text) => match text.as_str() {
                "true" => Ok(1.0),
                "false" => Ok(0.0),
                text => text.parse().map_err(|_| format!("'{text}' is no number")),
            },
            number => Ok(number.number().unwrap_or_default()),
        }
    }

    /// The value as text, numbers as C++ writes them.
    pub(in crate::tree) fn text(&self) -> String {
        match self {
            Self::Integer(value) => value.to_string(),
            Self::Real(value) => format!("{value:.6}"),
            Self::Text(text) => text.clone(),
        }
    }

    fn whole(&self) -> Result<i64, String> {
        match self {
            Self::Integer(value) => Ok(*value),
            Self::Real(value) if value.fract() == 0.0 && value.abs() < 9.0e18 => Ok(*value as i64),
            Self::Real(value) => Err(format!("{value} is no whole number")),
            Self::Text(text) => Err(format!("'{text}' is no number")),
        }
    }
}

impl From<bool> for Scalar {
    fn from(holds: bool) -> Self {
        Self::Real(f64::from(u8::from(holds)))
    }
}

/// Runs statements; the value is that of the last.
pub(super) fn statements(statements: &[Expression], variables: &mut dyn Variables) -> Result<Scalar, String> {
    let mut last = Scalar::from(false);
    for statement in statements {
        last = value(statement, variables)?;
    }
    Ok(last)
}

fn value(expression: &Expression, variables: &mut dyn Variables) -> Result<Scalar, String> {
    match expression {
        Expression::Literal(literal) => Ok(literal.clone()),
        Expression::Name(name) => {
            variables.value(name).ok_or_else(|| format!("there is no variable '{name}'"))
        }
        Expression::Prefix(prefix, operand) => prefixed(*prefix, &value(operand, variables)?),
        Expression::Binary(operator, left, right) => {
            let left = value(left, variables)?;
            binary(*operator, &left, &value(right, variables)?)
        }
        Expression::ComparisonOperator(first, others) => {
            let mut left = value(first, variables)?;
            for (comparison, other) in others {
                let right = value(other, variables)?;
                if !compares(*comparison, &left, &right)? {
                    return Ok(false.into());
                }
                left = right;
            }
            Ok(true.into())
        }
        Expression::Choice(parts) => {
            let [condition, then, otherwise] = &**parts;
            let condition = value(condition, variables)?;
            let holds = match &condition {
                Scalar::Text(text) => !text.is_empty(),
                number => number.truth()?,
            };
            value(if holds { then } else { otherwise }, variables)
        }
        Expression::Assignment(kind, name, right) => assign(*kind, name, right, variables),
    }
}

fn assign(
    kind: Assignment,
    name: &str,
    right: &Expression,
    variables: &mut dyn Variables,
) -> Result<Scalar, String> {
    let old = variables.value(name);
    if old.is_none() && kind != Assignment::Create {
        return Err(format!("there is no variable '{name}': ':=' makes one"));
    }
    let right = value(right, variables)?;
    let new = match (kind, &old) {
        (Assignment::Change(operator), Some(old)) => binary(operator, old, &right)?,
        (_, Some(Scalar::Integer(_) | Scalar::Real(_))) if right.number().is_none() => {
            Scalar::Real(right.as_number()?)
        }
        (_, Some(Scalar::Text(_))) if right.number().is_some() => {
            return Err(format!("'{name}' holds text, and a number cannot be assigned to it"));
        }
        _ => right,
    };
    variables.set(name, new.clone());
    Ok(new)
}

fn prefixed(prefix: Prefix, operand: &Scalar) -> Result<Scalar, String> {
    let Some(number) = operand.number() else { return Err("text cannot be negated".into()) };
    Ok(match prefix {
        Prefix::Minus => Scalar::Real(-number),
        Prefix::Complement => Scalar::Real(!(number as i64) as f64),
        Prefix::Not => (number == 0.0).into(),
    })
}

fn binary(operator: Binary, left: &Scalar, right: &Scalar) -> Result<Scalar, String> {
    match (left.number(), right.number()) {
        (Some(a), Some(b)) => numbers(operator, (a, b), left, right),
        (None, None) if matches!(operator, Binary::Add | Binary::Concatenate) => {
            Ok(Scalar::Text(left.text() + &right.text()))
        }
        _ if operator == Binary::Concatenate => Ok(Scalar::Text(left.text() + &right.text())),
        _ => Err(format!("text cannot be an operand of '{}'", operator.sign())),
    }
}

fn numbers(operator: Binary, (a, b): (f64, f64), left: &Scalar, right: &Scalar) -> Result<Scalar, String> {
    let bits = |join: fn(i64, i64) -> i64| Ok(Scalar::Real(join(left.whole()?, right.whole()?) as f64));
    match operator {
        Binary::Add => Ok(Scalar::Real(a + b)),
        Binary::Subtract => Ok(Scalar::Real(a - b)),
        Binary::Multiply => Ok(Scalar::Real(a * b)),
        Binary::Divide => Ok(Scalar::Real(a / b)),
        Binary::BitAnd => bits(|a, b| a & b),
        Binary::BitOr => bits(|a, b| a | b),
        Binary::BitXor => bits(|a, b| a ^ b),
        Binary::And => Ok((a != 0.0 && b != 0.0).into()),
        Binary::Or => Ok((a != 0.0 || b != 0.0).into()),
        Binary::Concatenate => Err("'..' joins text, and neither operand is".into()),
    }
}

fn compares(comparison: ComparisonOperator, left: &Scalar, right: &Scalar) -> Result<bool, String> {
    if let (Scalar::Text(left), Scalar::Text(right)) = (left, right) {
        return Ok(match comparison {
            ComparisonOperator::Equal => left == right,
            ComparisonOperator::Unequal => left != right,
            ComparisonOperator::Less => left < right,
            ComparisonOperator::Greater => left > right,
            ComparisonOperator::LessOrEqual => left <= right,
            ComparisonOperator::GreaterOrEqual => left >= right,
        });
    }
    let (left, right) = (left.as_number()?, right.as_number()?);
    let is_same = (left - right).abs() <= f64::from(f32::EPSILON);
    Ok(match comparison {
        ComparisonOperator::Equal => is_same,
        ComparisonOperator::Unequal => !is_same,
        ComparisonOperator::Less => left < right,
        ComparisonOperator::Greater => left > right,
        ComparisonOperator::LessOrEqual => left <= right,
        ComparisonOperator::GreaterOrEqual => left >= right,
    })
}

impl Binary {
    fn sign(self) -> &'static str {
        match self {
            Self::Add => "+",
            Self::Subtract => "-",
            Self::Multiply => "*",
            Self::Divide => "/",
            Self::Concatenate => "..",
            Self::BitAnd => "&",
            Self::BitOr => "|",
            Self::BitXor => "^",
            Self::And => "&&",
            Self::Or => "||",
        }
    }
}
