//! Where the mesh files of a robot description lie.

use std::collections::BTreeMap;
use std::path::{Path, PathBuf};

/// Larger files are not read, bytes.
const LARGEST: u64 = 256 << 20;

/// Finds mesh files for one description.
///
/// `package://NAME/rest` is looked for in the folder that was named for it, then in the folders above the description
/// (a folder `NAME` in one of them, or one that is called `NAME` itself), then in the folders to search.
/// Other names are relative to the description and may not lead farther out than the folder above its own.
#[derive(Debug, Clone)]
pub struct MeshFiles {
    /// Folder of the description.
    home: PathBuf,
    packages: BTreeMap<String, PathBuf>,
    search: Vec<PathBuf>,
    /// What a user may write to name a package's folder.
    named_in: &'static str,
}

impl MeshFiles {
    /// For the description at this path.
    pub fn beside(urdf: &Path) -> Self {
        let folder = urdf.parent().filter(|p| !p.as_os_str().is_empty());
        let home = folder.unwrap_or(Path::new("."));
        Self {
            home: home.canonicalize().unwrap_or_else(|_| home.to_owned()),
            packages: BTreeMap::new(),
            search: Vec::new(),
            named_in: "robot.packages",
        }
    }

    /// With the folders of packages by their names, as a scene gives them in `robot.packages`.
    #[must_use]
    pub fn with_packages(mut self, packages: &BTreeMap<String, String>) -> Self {
        let folders = packages.iter();
        self.packages
            .extend(folders.map(|(name, path)| (name.clone(), PathBuf::from(path))));
        self
    }

    /// With folders that hold packages, and the name of the variable or list that they come from, for messages.
    #[must_use]
    pub fn searching(mut self, folders: Vec<PathBuf>, named_in: &'static str) -> Self {
        self.search = folders;
        self.named_in = named_in;
        self
    }

    /// The bytes of a mesh by its name in the description.
    ///
    /// # Errors
    /// Where it was looked for and why there is nothing, or too much, to read.
    pub fn bytes(&self, name: &str) -> Result<Vec<u8>, String> {
        let path = self.find(name)?;
        let shown = path.display();
        let about = std::fs::metadata(&path).map_err(|error| format!("{shown}: {error}"))?;
        if !about.is_file() {
            return Err(format!("{shown} is not a file"));
        }
        let size = about.len();
        if size > LARGEST {
            return Err(format!(
                "{shown}: {size} bytes, at most {LARGEST} are read; make a coarser mesh of it"
            ));
        }
        std::fs::read(&path).map_err(|error| format!("{shown}: {error}"))
    }

    fn find(&self, name: &str) -> Result<PathBuf, String> {
        if let Some(rest) = name.strip_prefix("package://") {
            return self.in_package(rest);
        }
        let name = name.strip_prefix("file://").unwrap_or(name);
        if name.contains("://") || Path::new(name).is_absolute() {
            return Err(
                "expected package://NAME/PATH or a path relative to the description".to_owned(),
            );
        }
        let border = self.home.parent().unwrap_or(&self.home);
        inside(border, &self.home.join(name))
    }

    fn in_package(&self, rest: &str) -> Result<PathBuf, String> {
        let (package, file) = rest
            .split_once('/')
            .ok_or("expected package://NAME/PATH".to_owned())?;
        if let Some(root) = self.packages.get(package) {
            return inside(root, &root.join(file));
        }
        let above = self.home.ancestors().flat_map(|folder| {
            let own = folder.file_name().is_some_and(|n| n == package);
            let named = own.then(|| folder.to_owned());
            named.into_iter().chain([folder.join(package)])
        });
        let listed = self.search.iter().map(|folder| folder.join(package));
        for root in above.chain(listed) {
            if root.join(file).is_file() {
                return inside(&root, &root.join(file));
            }
        }
        Err(format!(
            "package '{package}' with '{file}' was found neither above {} nor in {}",
            self.home.display(),
            self.named_in
        ))
    }
}

/// The file, if it is there and does not lie outside of a folder.
fn inside(folder: &Path, file: &Path) -> Result<PathBuf, String> {
    let there = |path: &Path| {
        path.canonicalize()
            .map_err(|error| format!("{}: {error}", path.display()))
    };
    let (folder, file) = (there(folder)?, there(file)?);
    if file.starts_with(&folder) {
        Ok(file)
    } else {
        Err(format!(
            "{} lies outside of {}",
            file.display(),
            folder.display()
        ))
    }
}

#[cfg(test)]
mod tests {
    use std::collections::BTreeMap;

    use super::MeshFiles;

    #[test]
    fn packages_are_found_above_and_nothing_leads_out() {
        let top = std::env::temp_dir().join(format!("depal-meshes-{}", std::process::id()));
        let maker = top.join("maker_support");
        let write = |name: &str| {
            let path = maker.join(name);
            std::fs::create_dir_all(path.parent().expect("a folder")).expect("made");
            std::fs::write(path, name).expect("written");
        };
        for name in ["urdf/arm.urdf", "meshes/foot.stl", "urdf/near.obj"] {
            write(name);
        }
        std::fs::write(top.join("secret.stl"), "x").expect("written");
        let meshes = MeshFiles::beside(&maker.join("urdf/arm.urdf"));
        for (name, file) in [
            ("package://maker_support/meshes/foot.stl", "meshes/foot.stl"),
            ("../meshes/foot.stl", "meshes/foot.stl"),
            ("near.obj", "urdf/near.obj"),
            ("file://near.obj", "urdf/near.obj"),
        ] {
            assert_eq!(meshes.bytes(name), Ok(file.as_bytes().to_vec()), "{name}");
        }
        for (name, said) in [
            ("package://maker_support/../secret.stl", "lies outside of"),
            ("../../secret.stl", "lies outside of"),
            ("/etc/hostname", "relative to the description"),
            ("https://x/y.stl", "relative to the description"),
            ("package://other/foot.stl", "package 'other'"),
            ("lost.stl", "lost.stl"),
            ("../urdf", "is not a file"),
        ] {
            let error = meshes.bytes(name).expect_err(name);
            assert!(error.contains(said), "{error}");
        }
        let moved = MeshFiles::beside(&top.join("arm.urdf"));
        let name = "package://other_name/meshes/foot.stl";
        assert!(moved.bytes(name).is_err());
        let folder = maker.to_string_lossy().into_owned();
        let named = BTreeMap::from([("other_name".to_owned(), folder)]);
        let moved = moved.with_packages(&named);
        assert_eq!(moved.bytes(name), Ok(b"meshes/foot.stl".to_vec()));
        let error = moved.bytes("package://other_name/../secret.stl");
        assert!(error.expect_err("outside").contains("lies outside of"));
        // 300 MB that take no room on the disk.
        let large = std::fs::File::create(maker.join("meshes/large.stl")).expect("made");
        large.set_len(300 << 20).expect("long");
        let error = meshes.bytes("../meshes/large.stl").expect_err("too large");
        assert!(
            error.contains("314572800 bytes, at most 268435456"),
            "{error}"
        );
        std::fs::remove_dir_all(&top).expect("removed");
    }
}
