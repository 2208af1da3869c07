use std::collections::BTreeMap;

use crate::configuration::{ConfigurationError, entries};

/// Every attribute of the configuration files of a controller backup, as programs ask for it.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct ConfigurationData {
    /// Values by domain, type, name of the instance and attribute, all in lower case.
    values: BTreeMap<[String; 4], String>,
}

impl ConfigurationData {
    /// Takes over a file of a domain, `MOC`. An instance is known by its `-name`; one without is passed over.
    ///
    /// # Errors
    /// The file's head names another domain.
    pub fn read(&mut self, domain: &str, text: &str) -> Result<(), Vec<ConfigurationError>> {
        for entry in entries(text, domain)? {
            let Some(name) = entry.fields.get("name").map(|name| name.to_lowercase()) else {
                continue;
            };
            for (attribute, value) in entry.fields {
                let path = [
                    domain.to_lowercase(),
                    entry.section.to_lowercase(),
                    name.clone(),
                    attribute,
                ];
                self.values.insert(path, value);
            }
        }
        Ok(())
    }

    /// An attribute of an instance, whatever the case of the names. A flag without a value is empty.
    pub fn value(&self, instance: [&str; 3], attribute: &str) -> Option<&str> {
        let [domain, kind, name] = instance.map(str::to_lowercase);
        let path = [domain, kind, name, attribute.to_lowercase()];
        self.values.get(&path).map(String::as_str)
    }
}
