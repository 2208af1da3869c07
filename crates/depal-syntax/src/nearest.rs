/// The candidate with the fewest changes, if they are few for the length of the word; case does not count.
pub fn nearest_name(wanted: &str, candidates: impl Iterator<Item = String>) -> Option<String> {
    let key = wanted.to_lowercase();
    let limit = (key.chars().count() / 3).clamp(1, 4);
    candidates
        .map(|name| {
            let distance = strsim::damerau_levenshtein(&key, &name.to_lowercase());
            (distance, name)
        })
        .filter(|(distance, _)| *distance <= limit)
        .min()
        .map(|(_, name)| name)
}
