//! The files that hold one volume, known from its header alone.

use std::path::{Path, PathBuf};

use super::files::DataFiles;
use super::source::Source;
use super::{metaimage, nifti, nrrd};

/// The file named and those that belong to it: a header's data files, the other half of a NIfTI
/// pair. What cannot be opened or understood is left to [`super::read`] to complain of.
pub fn files_of(path: &Path) -> Vec<PathBuf> {
    let mut files = vec![path.to_owned()];
    files.extend(nifti::header_beside(path));
    let Ok(source) = Source::open(path) else {
        return files;
    };
    let head = source.head();
    let data = if nrrd::is_nrrd(head) {
        nrrd::data_files(head)
    } else if nifti::is_nifti(head) {
        files.extend(nifti::image_beside(path));
        None
    } else if metaimage::is_metaimage(head) {
        metaimage::data_files(head)
    } else {
        None
    };
    if let Some(DataFiles::Files(names)) = data {
        let folder = path.parent().unwrap_or(Path::new(""));
        files.extend(names.iter().map(|name| folder.join(name)));
    }
    files
}
