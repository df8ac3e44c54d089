//! Numbers typed while an operator runs: up to three fields, with a sign, corrected letter by letter.

/// Most letters of a field: more digits than a micrometre in a hundred metres needs.
const MAX_LETTERS: usize = 12;

/// The numbers typed so far.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Typed {
    fields: [String; 3],
    field: usize,
    /// Whether they say where something is to be, and not how far it is to go.
    pub is_absolute: bool,
}

impl Typed {
    /// Takes a letter: a digit, a decimal point or comma, `-` for the other sign, `=` for absolute or relative.
    ///
    /// False if it means nothing here.
    pub fn push(&mut self, letter: char) -> bool {
        let field = &mut self.fields[self.field];
        match letter {
            '0'..='9' if field.len() < MAX_LETTERS => field.push(letter),
            '.' | ',' if !field.contains('.') && field.len() < MAX_LETTERS => field.push('.'),
            '-' => match field.strip_prefix('-') {
                Some(rest) => *field = rest.to_owned(),
                None => field.insert(0, '-'),
            },
            '=' => self.is_absolute = !self.is_absolute,
            _ => return false,
        }
        true
    }

    /// Takes the last letter away; in an empty field, goes back to the one before. False if nothing was typed.
    pub fn back(&mut self) -> bool {
        if self.fields[self.field].pop().is_some() {
            return true;
        }
        let was_used = self.field > 0 || self.is_absolute;
        if self.field > 0 {
            self.field -= 1;
        } else {
            self.is_absolute = false;
        }
        was_used
    }

    /// Goes on to the next of `count` fields, after the last one to the first.
    pub fn next_field(&mut self, count: usize) {
        self.field = (self.field + 1) % count.clamp(1, self.fields.len());
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        *self = Self::default();
    }

    /// Whether no field has a letter.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.fields.iter().all(String::is_empty)
    }

    /// The numbers; a field without a digit has none.
    #[must_use]
    pub fn numbers(&self) -> [Option<f64>; 3] {
        self.fields.each_ref().map(|text| text.parse().ok().filter(|v: &f64| v.is_finite()))
    }

    /// What was typed in the first `count` fields, with a bar where the next letter goes.
    #[must_use]
    pub fn text(&self, count: usize) -> String {
        let shown = self
            .fields
            .iter()
            .take(count.max(self.field + 1))
            .enumerate()
            .map(|(k, text)| if k == self.field { format!("{text}|") } else { text.clone() });
        shown.collect::<Vec<_>>().join(", ")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn typed(letters: &str) -> Typed {
        let mut typed = Typed::default();
        for letter in letters.chars() {
            if letter == '\t' { typed.next_field(3) } else { assert!(typed.push(letter), "{letter:?}") }
        }
        typed
    }

    #[test]
    fn digits_points_and_signs_make_numbers() {
        let cases = [("12.5", 12.5), ("1,25", 1.25), (".5", 0.5), ("5.", 5.0), ("3-", -3.0), ("-3-", 3.0)];
        for (letters, number) in cases {
            assert_eq!(typed(letters).numbers()[0], Some(number), "{letters}");
        }
        assert_eq!(typed("-").numbers()[0], None, "a sign alone is no number yet");
        assert_eq!(typed("1\t-2\t3").numbers(), [Some(1.0), Some(-2.0), Some(3.0)], "three fields");
    }

    #[test]
    fn what_cannot_be_part_of_a_number_is_refused() {
        let mut half = typed("1.5");
        assert!(!half.push('.') && !half.push('x'), "a second point, a letter");
        let mut long = typed("123456789012");
        assert!(!long.push('3') && long.numbers()[0] == Some(123_456_789_012.0), "too long");
    }

    #[test]
    fn letters_are_taken_back_one_by_one_through_all_fields() {
        let mut two = typed("1\t25");
        for (text, numbers) in [("1, 2|", [Some(1.0), Some(2.0)]), ("1, |", [Some(1.0), None])] {
            assert!(two.back(), "{text}");
            assert_eq!((two.text(1).as_str(), &two.numbers()[..2]), (text, &numbers[..]), "after a step back");
        }
        assert!(two.back() && two.back() && two.is_empty(), "the first field too");
        assert!(!two.back(), "then there is nothing left");
    }

    #[test]
    fn the_equals_sign_switches_between_absolute_and_relative() {
        assert!(typed("=2").is_absolute && !typed("=2=").is_absolute, "each time the other");
    }
}
