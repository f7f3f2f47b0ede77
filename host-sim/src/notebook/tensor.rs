//! Tables of numbers with any number of axes, row-major.

use super::fault::{NotebookFault, refuse};
use super::json::JsonValue;

/// The tolerance for the sum of a column, which is then scaled to one.
const TOLERANCE: f64 = 1e-4;

/// The relative difference up to which two numbers count as the same.
const SAME: f64 = 1e-6;

/// A table; the last axis runs fastest.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct Tensor {
    shape: Vec<usize>,
    values: Vec<f64>,
}

impl Tensor {
    /// A table from nested lists of equal lengths, all its numbers finite. `name` is what messages
    /// call it.
    pub(super) fn read(value: &JsonValue, name: &str) -> Result<Self, NotebookFault> {
        let mut tensor = Self { shape: Vec::new(), values: Vec::new() };
        let mut first = value;
        while let JsonValue::List(items) = first {
            tensor.shape.push(items.len());
            let Some(item) = items.first() else {
                refuse!("{} is empty", place(name, &vec![0; tensor.shape.len() - 1]));
            };
            first = item;
        }
        tensor.fill(value, name, &mut Vec::new())?;
        Ok(tensor)
    }

    fn fill(&mut self, value: &JsonValue, name: &str, at: &mut Vec<usize>) -> Result<(), NotebookFault> {
        let Some(&length) = self.shape.get(at.len()) else {
            self.values.push(finite(value, || place(name, at))?);
            return Ok(());
        };
        let first = || place(name, &vec![0; at.len()]);
        let JsonValue::List(items) = value else {
            refuse!(
                "{name} is ragged: {} is {}, {} a list of {length}",
                place(name, at),
                value.shown(),
                first()
            );
        };
        if items.len() != length {
            let (here, there) = (place(name, at), first());
            refuse!("{name} is ragged: {here} has {} entries, {there} has {length}", items.len());
        }
        for (index, item) in items.iter().enumerate() {
            at.push(index);
            self.fill(item, name, at)?;
            at.pop();
        }
        Ok(())
    }

    pub(super) fn shape(&self) -> &[usize] {
        &self.shape
    }

    pub(super) fn values(&self) -> &[f64] {
        &self.values
    }

    /// The number of columns, a column running along the first axis.
    pub(super) fn columns(&self) -> usize {
        self.values.len() / self.shape[0]
    }

    /// The column with this number, row-major over the other axes.
    pub(super) fn column(&self, column: usize) -> impl Iterator<Item = f64> + '_ {
        self.values.iter().skip(column).step_by(self.columns()).copied()
    }

    /// The indices of the column with this number.
    fn indices(&self, mut column: usize) -> Vec<usize> {
        let mut indices = Vec::new();
        for &length in self.shape[1..].iter().rev() {
            indices.push(column % length);
            column /= length;
        }
        indices.reverse();
        indices
    }

    /// Checks that every column is a distribution, and scales it to sum to one.
    pub(super) fn normalise_columns(&mut self, name: &str) -> Result<(), NotebookFault> {
        let columns = self.columns();
        for column in 0..columns {
            let mut sum = 0.0;
            for (value, p) in self.column(column).enumerate() {
                if p < 0.0 {
                    let at = [vec![value], self.indices(column)].concat();
                    refuse!("{} is {p}: a probability is not negative", place(name, &at));
                }
                sum += p;
            }
            if (sum - 1.0).abs() > TOLERANCE {
                let indices: Vec<_> = self.indices(column).iter().map(usize::to_string).collect();
                let at = if indices.is_empty() {
                    String::new()
                } else {
                    format!(" column ({})", indices.join(", "))
                };
                refuse!("{name}{at} sums to {}, not to 1", shown(sum));
            }
            self.values.iter_mut().skip(column).step_by(columns).for_each(|p| *p /= sum);
        }
        Ok(())
    }

    /// Whether nothing changes along an axis.
    pub(super) fn is_constant_along(&self, axis: usize) -> bool {
        let inner: usize = self.shape[axis + 1..].iter().product();
        self.values.chunks(inner * self.shape[axis]).all(|block| {
            let (first, others) = block.split_at(inner);
            others.chunks(inner).all(|other| other.iter().zip(first).all(|(a, b)| alike(*a, *b)))
        })
    }

    /// The table at index zero of an axis.
    pub(super) fn without(&self, axis: usize) -> Self {
        let inner: usize = self.shape[axis + 1..].iter().product();
        let blocks = self.values.chunks(inner * self.shape[axis]);
        let mut shape = self.shape.clone();
        shape.remove(axis);
        Self { shape, values: blocks.flat_map(|block| &block[..inner]).copied().collect() }
    }

    /// The table with its axes in another order: axis `i` of the result is axis `order[i]` of this
    /// one.
    pub(super) fn transposed(&self, order: &[usize]) -> Self {
        let stride = |axis: usize| self.shape[axis + 1..].iter().product::<usize>();
        let shape: Vec<_> = order.iter().map(|&axis| self.shape[axis]).collect();
        let strides: Vec<_> = order.iter().map(|&axis| stride(axis)).collect();
        let mut values = Vec::with_capacity(self.values.len());
        let mut now = vec![0; shape.len()];
        for _ in 0..self.values.len() {
            values.push(
                self.values[now.iter().zip(&strides).map(|(index, stride)| index * stride).sum::<usize>()],
            );
            for (index, &length) in now.iter_mut().zip(&shape).rev() {
                *index += 1;
                if *index < length {
                    break;
                }
                *index = 0;
            }
        }
        Self { shape, values }
    }

    /// The numbers as the robot has them.
    pub(super) fn to_f32(&self) -> Vec<f32> {
        self.values.iter().map(|&value| value as f32).collect()
    }
}

/// Whether two probabilities are the same number, but for rounding; zero is only itself.
pub(super) fn alike(a: f64, b: f64) -> bool {
    a == b || (a - b).abs() <= SAME * a.abs().max(b.abs())
}

/// `name[i][j]...`
pub(super) fn place(name: &str, at: &[usize]) -> String {
    at.iter().fold(name.to_owned(), |place, index| place + &format!("[{index}]"))
}

/// A finite number, or a refusal that names its place.
pub(super) fn finite(value: &JsonValue, place: impl Fn() -> String) -> Result<f64, NotebookFault> {
    match value {
        JsonValue::Number(number) if number.is_finite() => Ok(*number),
        JsonValue::Number(number) => refuse!("{} is {number}, not a finite number", place()),
        JsonValue::List(_) => {
            refuse!("{} is a list where its like are numbers: the table is ragged", place())
        }
        other => refuse!("{} is {}, not a number", place(), other.kind()),
    }
}

/// A sum without the noise of its last places.
fn shown(sum: f64) -> String {
    let text = format!("{sum:.6}");
    text.trim_end_matches('0').trim_end_matches('.').to_owned()
}

#[cfg(test)]
mod tests {
    use super::super::json;
    use super::*;

    fn tensor(text: &str) -> Result<Tensor, String> {
        let value = json::read(text.as_bytes()).expect("JSON");
        Tensor::read(&value, "A[2]").map_err(|fault| fault.in_file("f").to_string())
    }

    fn refusal(text: &str) -> String {
        tensor(text)
            .and_then(|mut tensor| {
                tensor.normalise_columns("A[2]").map_err(|fault| fault.in_file("f").to_string())
            })
            .expect_err(text)
    }

    #[test]
    fn a_table_that_is_none_is_refused_by_its_place() {
        assert_eq!(refusal("[[1, 0.5], [0, 0.47]]"), "f: A[2] column (1) sums to 0.97, not to 1");
        assert_eq!(refusal("[[1, 1.5], [0, -0.5]]"), "f: A[2][1][1] is -0.5: a probability is not negative");
        assert_eq!(refusal("[[1, 0.5], [0, NaN]]"), "f: A[2][1][1] is NaN, not a finite number");
        assert_eq!(refusal("[[1, 0.5], [0]]"), "f: A[2] is ragged: A[2][1] has 1 entries, A[2][0] has 2");
        assert_eq!(refusal("[[1, 0.5], 3]"), "f: A[2] is ragged: A[2][1] is 3, A[2][0] a list of 2");
        assert!(refusal("[[1, [0.5]], [0, 3]]").starts_with("f: A[2][0][1] is a list"));
        assert_eq!(refusal("[[1, \"x\"], [0, 3]]"), "f: A[2][0][1] is a text, not a number");
        assert_eq!(refusal("[[], [1]]"), "f: A[2][0] is empty");
        assert_eq!(refusal("[]"), "f: A[2] is empty");
    }

    #[test]
    fn axes_are_swapped_and_dropped() {
        let table = tensor("[[[1, 2, 3], [4, 5, 6]]]").expect("a table");
        let turned = table.transposed(&[2, 0, 1]);
        assert_eq!((turned.shape(), turned.values()), (&[3, 1, 2][..], &[1.0, 4.0, 2.0, 5.0, 3.0, 6.0][..]));
        assert!(!table.is_constant_along(1) && !table.is_constant_along(2) && table.is_constant_along(0));
        assert_eq!(table.without(1).values(), [1.0, 2.0, 3.0]);
        assert_eq!(table.without(2).values(), [1.0, 4.0]);
    }

    #[test]
    fn columns_of_a_float32_notebook_are_scaled() {
        let mut table = tensor("[[0.89999998, 0.1], [0.1, 0.90005]]").expect("a table");
        table.normalise_columns("A[0]").expect("distributions");
        assert!((0..2).all(|column| (table.column(column).sum::<f64>() - 1.0).abs() < 1e-15));
    }
}
