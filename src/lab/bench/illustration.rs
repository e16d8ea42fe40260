//! Pictures beside the figures.

use crate::frame::Frame;

/// A picture that belongs to the findings.
pub struct Illustration {
    /// The section of the page in which it is shown.
    pub section: String,
    /// The label in the report.
    pub label: String,
    /// One line that says what the picture shows.
    pub caption: String,
    /// The picture, with its display plane.
    pub frame: Frame,
}

impl Illustration {
    /// The names of the files of `pictures`, each another; also where upper and lower case are one.
    pub fn files(pictures: &[Self]) -> Vec<String> {
        let mut files: Vec<String> = Vec::new();
        for picture in pictures {
            let stem = picture.stem();
            let numbered = (2..).map(|n| format!("{stem}-{n}.png"));
            let mut names = std::iter::once(format!("{stem}.png")).chain(numbered);
            let is_free = |name: &String| {
                let mut taken = files.iter();
                !taken.any(|other| other.to_lowercase() == name.to_lowercase())
            };
            files.extend(names.find(is_free));
        }
        files
    }

    /// Section and label, of which letters, digits and points stay.
    fn stem(&self) -> String {
        let name = format!("{} {}", self.section, self.label);
        let words = name.split(|c: char| !(c.is_alphanumeric() || c == '.'));
        let words: Vec<&str> = words.filter(|word| !word.is_empty()).collect();
        words.join("-")
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::extent::ImageSize;
    use crate::frame::Wanted;

    #[test]
    fn no_two_pictures_have_one_file() {
        let of = |section: &str| Illustration {
            section: section.into(),
            label: "map".into(),
            caption: String::new(),
            frame: Frame::blank(ImageSize::new(1, 1).unwrap(), Wanted::DISPLAY).unwrap(),
        };
        let names = ["head_1", "head-1", "Head 1", "head-1 map-2", "neck"];
        let expected = [
            "head-1-map.png",
            "head-1-map-2.png",
            "Head-1-map-3.png",
            "head-1-map-2-map.png",
            "neck-map.png",
        ];
        assert_eq!(Illustration::files(&names.map(of)), expected);
    }
}
