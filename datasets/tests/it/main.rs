//! Laws of the generated shapes.

#[cfg(test)]
mod articulated;
#[cfg(test)]
mod creatures;
