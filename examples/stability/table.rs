//! Rows of figures, and whether each keeps its limit.

/// Figures of one axis.
pub(crate) struct Table {
    pub(crate) title: &'static str,
    /// What was done, what the columns are, and the limits.
    pub(crate) text: String,
    pub(crate) columns: &'static [&'static str],
    pub(crate) rows: Vec<Row>,
}

/// One case.
pub(crate) struct Row {
    pub(crate) cells: Vec<String>,
    /// What does not keep its limit.
    pub(crate) faults: Vec<String>,
}

impl Row {
    /// Of a case that came to nothing, or of one with its cells.
    pub(crate) fn of(case: impl Into<String>, found: Result<(Vec<String>, Vec<String>), String>) -> Row {
        let case = case.into();
        match found {
            Ok((cells, faults)) => Row { cells: std::iter::once(case).chain(cells).collect(), faults },
            Err(fault) => Row { cells: vec![case], faults: vec![fault] },
        }
    }
}

impl Table {
    /// What fails, each with its case.
    pub(crate) fn faults(&self) -> Vec<String> {
        let of_row = |row: &Row| {
            let case = row.cells.first().cloned().unwrap_or_default();
            row.faults.iter().map(move |fault| format!("{}, {case}: {fault}", self.title)).collect::<Vec<_>>()
        };
        self.rows.iter().flat_map(of_row).collect()
    }

    /// As Markdown.
    pub(crate) fn markdown(&self) -> String {
        let mut text = format!("## {}\n\n{}\n\n", self.title, self.text);
        let line = |cells: &[String]| format!("| {} |\n", cells.join(" | "));
        text += &line(&self.columns.iter().map(|c| (*c).to_owned()).chain(["holds".to_owned()]).collect::<Vec<_>>());
        text += &line(&vec!["---".to_owned(); self.columns.len() + 1]);
        for row in &self.rows {
            let mut cells = row.cells.clone();
            cells.resize(self.columns.len(), String::new());
            cells.push(if row.faults.is_empty() { "yes".to_owned() } else { format!("NO: {}", row.faults.join("; ")) });
            text += &line(&cells);
        }
        text
    }
}

/// A small number, short.
pub(crate) fn short(value: f64) -> String {
    if value == 0.0 { "0".to_owned() } else { format!("{value:.1e}") }
}
