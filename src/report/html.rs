//! Markup: everything that enters as text is escaped here, and nowhere else.

use super::Image;
use super::style::CSS;
use crate::plot::{Format, Plot, PlotError};
use base64::Engine as _;
use base64::prelude::BASE64_STANDARD;

/// How far a part of the page can be trusted.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Status {
    /// It belongs to the project as it is.
    Current,
    /// Something it depends on has changed since.
    Stale,
    /// It was not computed.
    Missing,
}

impl Status {
    fn class_and_text(self) -> (&'static str, &'static str) {
        match self {
            Self::Current => ("current", "up to date"),
            Self::Stale => ("stale", "out of date"),
            Self::Missing => ("missing", "not computed"),
        }
    }
}

/// The page as it grows.
#[derive(Debug)]
pub(super) struct Page {
    text: String,
}

/// A text whose marks mean nothing to a browser; control characters, which no document may hold, become a mark.
pub(super) fn escaped(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\n' | '\t' => out.push(' '),
            c if c.is_control() || matches!(c, '\u{fffe}' | '\u{ffff}') => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

impl Page {
    pub(super) fn new(title: &str) -> Self {
        let title = escaped(title);
        let text = format!(
            "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\"/>\n\
             <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\"/>\n\
             <title>{title}, antenna report</title>\n<style>{CSS}</style>\n</head>\n<body>\n\
             <header>\n<h1>{title}</h1>\n<p>Report of a deformed antenna</p>\n</header>\n<main>\n"
        );
        Self { text }
    }

    pub(super) fn finish(mut self) -> String {
        let version = env!("CARGO_PKG_VERSION");
        self.text.push_str(&format!(
            "</main>\n<footer>Conformant {version}. Lengths are in millimetres unless another unit stands beside them; \
             errors are against the antenna as drawn.</footer>\n</body>\n</html>\n"
        ));
        self.text
    }

    /// Begins a section.
    pub(super) fn section(&mut self, title: &str, status: Option<Status>) {
        let badge = status.map_or_else(String::new, |status| {
            let (class, text) = status.class_and_text();
            format!("<span class=\"badge {class}\">{text}</span>")
        });
        self.text.push_str(&format!("<h2>{}{badge}</h2>\n", escaped(title)));
    }

    pub(super) fn heading(&mut self, title: &str) {
        self.text.push_str(&format!("<h3>{}</h3>\n", escaped(title)));
    }

    pub(super) fn paragraph(&mut self, text: &str) {
        self.text.push_str(&format!("<p>{}</p>\n", escaped(text)));
    }

    /// The figures that matter most: value and name.
    pub(super) fn key_figures(&mut self, figures: &[(String, String)]) {
        self.text.push_str("<ul class=\"key\">\n");
        for (value, name) in figures {
            self.text.push_str(&format!("<li><b>{}</b><span>{}</span></li>\n", escaped(value), escaped(name)));
        }
        self.text.push_str("</ul>\n");
    }

    /// Names with their values.
    pub(super) fn pairs(&mut self, rows: &[(String, String)]) {
        self.text.push_str("<table>\n<tbody>\n");
        for (name, value) in rows {
            self.text.push_str(&format!(
                "<tr><th scope=\"row\">{}</th><td>{}</td></tr>\n",
                escaped(name),
                escaped(value)
            ));
        }
        self.text.push_str("</tbody>\n</table>\n");
    }

    /// A table whose first column names the rows.
    pub(super) fn table(&mut self, head: &[&str], rows: &[Vec<String>]) {
        let cells: String = head.iter().map(|h| format!("<th scope=\"col\">{}</th>", escaped(h))).collect();
        self.text.push_str(&format!("<table>\n<thead><tr>{cells}</tr></thead>\n<tbody>\n"));
        for row in rows {
            let cells = row.iter().enumerate().map(|(k, cell)| match k {
                0 => format!("<th scope=\"row\">{}</th>", escaped(cell)),
                _ => format!("<td class=\"number\">{}</td>", escaped(cell)),
            });
            self.text.push_str(&format!("<tr>{}</tr>\n", cells.collect::<String>()));
        }
        self.text.push_str("</tbody>\n</table>\n");
    }

    /// A plot as vectors.
    pub(super) fn plot(&mut self, plot: &Plot, caption: &str) -> Result<(), PlotError> {
        let svg = String::from_utf8_lossy(&plot.bytes(Format::Svg)?).into_owned();
        // Within a page the prologue is wrong and the name space is known.
        let start = svg.find("<svg").unwrap_or(0);
        let svg = svg[start..].replacen(" xmlns=\"http://www.w3.org/2000/svg\"", "", 1);
        let caption = escaped(caption);
        self.text.push_str(&format!("<figure>\n{}\n<figcaption>{caption}</figcaption>\n</figure>\n", svg.trim_end()));
        Ok(())
    }

    /// A picture within the page.
    pub(super) fn image(&mut self, image: &Image) {
        let (caption, png) = (escaped(&image.caption), BASE64_STANDARD.encode(&image.png));
        self.text.push_str(&format!(
            "<figure>\n<img alt=\"{caption}\" src=\"data:image/png;base64,{png}\"/>\n<figcaption>{caption}</figcaption>\n\
             </figure>\n"
        ));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_in_a_text_can_end_it() {
        let text = escaped("<script>\"a\" & 'b'</script>\n\u{0}");
        assert_eq!(text, "&lt;script&gt;&quot;a&quot; &amp; &#39;b&#39;&lt;/script&gt; \u{fffd}", "escaped");
    }
}
