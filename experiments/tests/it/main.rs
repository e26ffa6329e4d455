//! The program: its page in a browser (pictures go to `target/browser`), interruptions and kills, and the chapters of the guide.

#[cfg(test)]
mod guide;
#[cfg(test)]
mod interruption;
#[cfg(test)]
mod page;
