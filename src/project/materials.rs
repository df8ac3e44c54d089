//! Materials to choose from by name: published values of substrates and of conducting sheets.
//!
//! A project keeps name and values of what was chosen, so that it means the same whatever becomes of this list; a
//! material whose values were changed has no name until the user gives it one. Values of laminates are their makers';
//! those of fabrics and inks are typical ones that vary with weave, humidity and batch: measure yours where it matters.

use super::{MaterialSpec, MetalSpec};

/// A dielectric to choose from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KnownDielectric {
    /// Its name.
    pub name: &'static str,
    /// Relative permittivity.
    pub eps_r: f64,
    /// Loss tangent.
    pub tan_delta: f64,
    /// What it is, and what its values hold for.
    pub note: &'static str,
}

/// A conducting sheet to choose from.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct KnownMetal {
    /// Its name.
    pub name: &'static str,
    /// Ohm per square of the whole sheet.
    pub ohm_per_square: f64,
    /// What it is.
    pub note: &'static str,
}

const fn dielectric(name: &'static str, eps_r: f64, tan_delta: f64, note: &'static str) -> KnownDielectric {
    KnownDielectric { name, eps_r, tan_delta, note }
}

const fn metal(name: &'static str, ohm_per_square: f64, note: &'static str) -> KnownMetal {
    KnownMetal { name, ohm_per_square, note }
}

/// Substrates and sheaths.
pub const DIELECTRICS: [KnownDielectric; 17] = [
    dielectric("RT/duroid 5880", 2.2, 0.0009, "PTFE with glass microfibres, at 10 GHz"),
    dielectric("RT/duroid 5870", 2.33, 0.0012, "PTFE with glass microfibres, at 10 GHz"),
    dielectric("RO3003", 3.0, 0.001, "PTFE with ceramic, at 10 GHz"),
    dielectric("RO4003C", 3.38, 0.0027, "Ceramic laminate, at 10 GHz; design work often takes 3.55"),
    dielectric("RO4350B", 3.48, 0.0037, "Ceramic laminate, at 10 GHz; design work often takes 3.66"),
    dielectric("FR-4", 4.4, 0.02, "Glass and epoxy; varies by maker and frequency"),
    dielectric("PTFE", 2.1, 0.0003, "Solid, as in coaxial cables"),
    dielectric("Polyethylene", 2.25, 0.0004, "Solid, as in coaxial cables"),
    dielectric("Kapton", 3.4, 0.002, "Polyimide film"),
    dielectric("PDMS", 2.7, 0.02, "Silicone rubber; losses vary with curing and frequency"),
    dielectric("Felt", 1.38, 0.023, "Textile, typical"),
    dielectric("Denim", 1.67, 0.02, "Cotton twill, typical; 1.6 to 1.7 are published"),
    dielectric("Cotton", 1.6, 0.04, "Textile, typical; grows with humidity"),
    dielectric("Polyester", 1.9, 0.0045, "Woven textile, typical"),
    dielectric("Polyester fleece", 1.17, 0.0035, "Textile, typical"),
    dielectric("Foam", 1.05, 0.0003, "Rigid PMI foam"),
    dielectric("Air", 1.0, 0.0, "Vacuum, in effect"),
];

/// Sheets for patch and ground.
pub const METALS: [KnownMetal; 6] = [
    metal("Copper-plated nylon ripstop", 0.04, "Conductive fabric, typical"),
    metal("Copper-plated nylon weave", 0.07, "Conductive fabric such as Flectron, typical"),
    metal("Nickel-copper polyester", 0.5, "Conductive fabric such as Shieldit Super, nominal"),
    metal("Silver-plated nylon knit", 0.6, "Stretchable conductive fabric, typical"),
    metal("Silver ink", 0.05, "Screen-printed, about 10 um thick, typical"),
    metal("Conductive polymer coating", 15.0, "On polyester non-woven, nominal"),
];

/// Letters and digits of a name, so that fr4 finds FR-4.
fn plain(name: &str) -> String {
    name.chars().filter(|c| c.is_alphanumeric()).flat_map(char::to_lowercase).collect()
}

/// The one of some names that is meant: the same but for case and punctuation, or the only one that begins with or else
/// holds what was typed.
fn meant<'a, T>(all: &'a [T], typed: &str, name: impl Fn(&T) -> &str) -> Option<&'a T> {
    let typed = plain(typed);
    let find = |fits: &dyn Fn(&str) -> bool| {
        let mut found = all.iter().filter(|one| fits(&plain(name(one))));
        found.next().filter(|_| found.next().is_none())
    };
    find(&|n| n == typed).or_else(|| find(&|n| n.starts_with(&typed))).or_else(|| find(&|n| n.contains(&typed)))
}

/// The dielectric of the library that a typed name means; `None` if there is none, or several.
#[must_use]
pub fn dielectric_named(typed: &str) -> Option<MaterialSpec> {
    meant(&DIELECTRICS, typed, |d| d.name).map(KnownDielectric::to_spec)
}

/// The sheet of the library that a typed name means; `None` if there is none, or several.
#[must_use]
pub fn metal_named(typed: &str) -> Option<MetalSpec> {
    meant(&METALS, typed, |m| m.name).map(KnownMetal::to_spec)
}

impl KnownDielectric {
    /// As a project keeps it.
    #[must_use]
    pub fn to_spec(&self) -> MaterialSpec {
        MaterialSpec { name: self.name.to_owned(), eps_r: self.eps_r, tan_delta: self.tan_delta }
    }
}

impl KnownMetal {
    /// As a project keeps it.
    #[must_use]
    pub fn to_spec(&self) -> MetalSpec {
        MetalSpec::Sheet { name: self.name.to_owned(), ohm_per_square: self.ohm_per_square }
    }
}

impl MaterialSpec {
    /// The same with the library's name, if it has none and its values are exactly the library's.
    #[must_use]
    pub fn recognized(self) -> Self {
        let same = |d: &&KnownDielectric| {
            d.eps_r.to_bits() == self.eps_r.to_bits() && d.tan_delta.to_bits() == self.tan_delta.to_bits()
        };
        match DIELECTRICS.iter().find(same) {
            Some(known) if self.name.is_empty() => known.to_spec(),
            _ => self,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Project;
    use super::*;
    use std::collections::HashSet;

    #[test]
    fn every_material_can_be_used_and_is_found_by_its_name() {
        let names: HashSet<String> =
            DIELECTRICS.iter().map(|d| plain(d.name)).chain(METALS.iter().map(|m| plain(m.name))).collect();
        assert_eq!(names.len(), DIELECTRICS.len() + METALS.len(), "names differ in letters or digits");
        for known in &DIELECTRICS {
            let mut project = Project::default();
            project.antenna.substrate = dielectric_named(known.name).expect("by its full name");
            assert_eq!(project.antenna.substrate, known.to_spec(), "{}", known.name);
            assert_eq!(project.validate(), Ok(()), "{}", known.name);
        }
        for known in &METALS {
            let mut project = Project::default();
            project.antenna.patch_metal = metal_named(known.name).expect("by its full name");
            assert_eq!(project.antenna.patch_metal, known.to_spec(), "{}", known.name);
            assert_eq!(project.validate(), Ok(()), "{}", known.name);
        }
    }

    #[test]
    fn names_are_found_however_they_are_typed_unless_they_mean_several() {
        for (typed, found) in
            [("fr4", "FR-4"), ("5880", "RT/duroid 5880"), ("POLYESTER", "Polyester"), ("denim", "Denim")]
        {
            assert_eq!(dielectric_named(typed).map(|d| d.name).as_deref(), Some(found), "{typed}");
        }
        for typed in ["duroid", "tweed", ""] {
            assert_eq!(dielectric_named(typed), None, "{typed} means none, or several");
        }
        assert_eq!(metal_named("ripstop"), Some(METALS[0].to_spec()), "a part of a name");
    }

    #[test]
    fn values_of_the_library_are_recognized() {
        let nameless = |eps_r, tan_delta| MaterialSpec { name: String::new(), eps_r, tan_delta };
        assert_eq!(nameless(4.4, 0.02).recognized().name, "FR-4", "the same values");
        assert_eq!(nameless(4.4, 0.021).recognized().name, "", "others");
    }
}
