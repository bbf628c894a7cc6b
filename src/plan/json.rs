//! JSON as a plan is written: indented like any pretty JSON, but lists of plain values stay on one line, so that a matrix
//! is four rows.

use std::io::{self, Write};

use serde_json::ser::Formatter;

/// Two spaces a level.
const INDENT: &[u8] = b"  ";

/// Indents objects, and lists that hold lists or objects.
#[derive(Default)]
pub(super) struct RowFormatter {
    /// One entry an open list or object: true once something in it started a line of its own.
    open: Vec<bool>,
    /// A value of a list is about to be written, and is not known yet to be a list or object.
    at_list_value: bool,
}

impl RowFormatter {
    fn new_line<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        writer.write_all(b"\n")?;
        for _ in 0..self.open.len() {
            writer.write_all(INDENT)?;
        }
        if let Some(inner) = self.open.last_mut() {
            *inner = true;
        }
        Ok(())
    }

    fn begin<W: ?Sized + Write>(&mut self, writer: &mut W, bracket: &[u8]) -> io::Result<()> {
        if std::mem::take(&mut self.at_list_value) {
            self.new_line(writer)?;
        }
        self.open.push(false);
        writer.write_all(bracket)
    }

    fn end<W: ?Sized + Write>(&mut self, writer: &mut W, bracket: &[u8]) -> io::Result<()> {
        if self.open.pop() == Some(true) {
            writer.write_all(b"\n")?;
            for _ in 0..self.open.len() {
                writer.write_all(INDENT)?;
            }
        }
        writer.write_all(bracket)
    }
}

impl Formatter for RowFormatter {
    fn begin_array<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.begin(writer, b"[")
    }

    fn end_array<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.end(writer, b"]")
    }

    fn begin_array_value<W: ?Sized + Write>(&mut self, writer: &mut W, first: bool) -> io::Result<()> {
        self.at_list_value = true;
        if first { Ok(()) } else { writer.write_all(b",") }
    }

    fn end_array_value<W: ?Sized + Write>(&mut self, _: &mut W) -> io::Result<()> {
        self.at_list_value = false;
        Ok(())
    }

    fn begin_object<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.begin(writer, b"{")
    }

    fn end_object<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        self.end(writer, b"}")
    }

    fn begin_object_key<W: ?Sized + Write>(&mut self, writer: &mut W, first: bool) -> io::Result<()> {
        if !first {
            writer.write_all(b",")?;
        }
        self.new_line(writer)
    }

    fn begin_object_value<W: ?Sized + Write>(&mut self, writer: &mut W) -> io::Result<()> {
        writer.write_all(b": ")
    }
}

#[cfg(test)]
mod tests {
    use serde::Serialize;
    use serde_json::json;

    use super::*;

    #[test]
    fn rows_stay_on_one_line() {
        let value = json!({"a": [[1.5, 2], [3, 4]], "b": [], "c": {}, "d": [{"e": null}, {"f": [true]}]});
        let mut bytes = Vec::new();
        value.serialize(&mut serde_json::Serializer::with_formatter(&mut bytes, RowFormatter::default())).unwrap();
        let text = String::from_utf8(bytes).unwrap();
        let expected = r#"{
  "a": [
    [1.5,2],
    [3,4]
  ],
  "b": [],
  "c": {},
  "d": [
    {
      "e": null
    },
    {
      "f": [true]
    }
  ]
}"#;
        assert_eq!(text, expected);
        assert_eq!(serde_json::from_str::<serde_json::Value>(&text).unwrap(), value);
    }
}
