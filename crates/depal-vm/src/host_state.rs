use std::any::Any;
use std::fmt::{self, Debug};

/// State of a language's built-ins that is no value of the language: plain data, so that a machine with it can be
/// cloned.
trait HostObject: Any + Debug + Send + Sync {
    fn boxed_clone(&self) -> Box<dyn HostObject>;
    fn as_any_mut(&mut self) -> &mut dyn Any;
}

impl<T: Any + Clone + Debug + Send + Sync> HostObject for T {
    fn boxed_clone(&self) -> Box<dyn HostObject> {
        Box::new(self.clone())
    }

    fn as_any_mut(&mut self) -> &mut dyn Any {
        self
    }
}

/// A box for what the built-ins of a language remember, of a type that the machine does not know.
#[derive(Default)]
pub struct HostState(Option<Box<dyn HostObject>>);

impl HostState {
    /// With this state inside.
    pub fn new<T: Any + Clone + Debug + Send + Sync>(state: T) -> Self {
        Self(Some(Box::new(state)))
    }

    /// The state, if it is of this type.
    pub fn get_mut<T: Any>(&mut self) -> Option<&mut T> {
        // Through the trait object: a box would be cloneable and `Any` itself.
        let object: &mut dyn HostObject = self.0.as_deref_mut()?;
        object.as_any_mut().downcast_mut()
    }
}

impl Clone for HostState {
    fn clone(&self) -> Self {
        Self(self.0.as_deref().map(HostObject::boxed_clone))
    }
}

impl Debug for HostState {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.0 {
            Some(state) => Debug::fmt(state, f),
            None => f.write_str("empty"),
        }
    }
}

impl PartialEq for HostState {
    /// Whether both show the same.
    fn eq(&self, other: &Self) -> bool {
        format!("{self:?}") == format!("{other:?}")
    }
}
