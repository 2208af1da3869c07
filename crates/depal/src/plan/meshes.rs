//! Where the mesh files of a robot description lie.

use std::path::{Path, PathBuf};

/// Larger files are not read, bytes.
const LARGEST: u64 = 256 << 20;

/// Finds mesh files for one description.
///
/// `package://NAME/rest` is looked for in the folders above the description (a folder `NAME` in one of them,
/// or one that is called `NAME` itself) and in the folders of `ROS_PACKAGE_PATH`.
/// Other names are relative to the description and may not lead farther out than the folder above its own.
pub(super) struct Meshes {
    /// Folder of the description.
    home: PathBuf,
    packages: Vec<PathBuf>,
}

impl Meshes {
    pub fn beside(urdf: &Path) -> Self {
        let folder = urdf.parent().filter(|p| !p.as_os_str().is_empty());
        let home = folder.unwrap_or(Path::new("."));
        let home = home.canonicalize().unwrap_or_else(|_| home.to_owned());
        let packages = std::env::var_os("ROS_PACKAGE_PATH");
        Self {
            home,
            packages: packages
                .map(|list| std::env::split_paths(&list).collect())
                .unwrap_or_default(),
        }
    }

    pub fn bytes(&self, name: &str) -> Result<Vec<u8>, String> {
        let path = self.find(name)?;
        let shown = path.display();
        let size = std::fs::metadata(&path)
            .map_err(|error| format!("{shown}: {error}"))?
            .len();
        if size > LARGEST {
            return Err(format!("{shown}: {size} bytes, at most {LARGEST} are read"));
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
        let above = self.home.ancestors().flat_map(|folder| {
            let own = folder.file_name().is_some_and(|n| n == package);
            let named = own.then(|| folder.to_owned());
            named.into_iter().chain([folder.join(package)])
        });
        let listed = self.packages.iter().map(|folder| folder.join(package));
        for root in above.chain(listed) {
            if root.join(file).is_file() {
                return inside(&root, &root.join(file));
            }
        }
        Err(format!(
            "package '{package}' with '{file}' was found neither above {} nor in ROS_PACKAGE_PATH",
            self.home.display()
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
    use super::Meshes;

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
        let meshes = Meshes::beside(&maker.join("urdf/arm.urdf"));
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
        ] {
            let error = meshes.bytes(name).expect_err(name);
            assert!(error.contains(said), "{error}");
        }
        std::fs::remove_dir_all(&top).expect("removed");
    }
}
