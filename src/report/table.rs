//! Markdown tables whose rows have as many cells as their head.

/// A table. Cells of a line are divided by `|`, so that a row is one format.
pub struct Table {
    columns: usize,
    text: String,
}

impl Table {
    /// A table with this head. The first `names` columns hold text, the others numbers, which stand to the right.
    pub fn new(names: usize, head: &str) -> Table {
        let columns = head.split('|').count();
        let mut table = Table { columns, text: String::new() };
        table.row(head);
        table.text.push('|');
        for column in 0..columns {
            table.text.push_str(if column < names { " --- |" } else { " --: |" });
        }
        table.text.push('\n');
        table
    }

    /// Adds a row.
    ///
    /// # Panics
    /// When it has another number of cells than the head.
    pub fn row(&mut self, cells: impl AsRef<str>) {
        let cells: Vec<&str> = cells.as_ref().split('|').map(str::trim).collect();
        assert_eq!(cells.len(), self.columns, "a row has as many cells as the head: {}", cells.join(" | "));
        self.text.push('|');
        for cell in cells {
            self.text.push(' ');
            self.text.push_str(cell);
            self.text.push_str(if cell.is_empty() { "|" } else { " |" });
        }
        self.text.push('\n');
    }

    /// The table's lines.
    pub fn text(&self) -> &str {
        &self.text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn empty_cells_count() {
        let mut table = Table::new(1, "name | error |");
        table.row("a | 1 | ★");
        table.row("b |  | ");
        assert_eq!(table.text(), "| name | error | |\n| --- | --: | --: |\n| a | 1 | ★ |\n| b | | |\n");
    }

    #[test]
    #[should_panic(expected = "as many cells")]
    fn a_short_row_is_a_fault() {
        Table::new(0, "a | b").row("1");
    }
}
