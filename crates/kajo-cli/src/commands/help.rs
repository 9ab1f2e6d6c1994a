//! `kajo help`: commands, and the blocks of the scene language with their fields.

use kajo::language::{Block, FieldSpec, Kind, block_of, blocks};
use kajo::nearest;

use crate::args::{Cli, HelpArgs};
use crate::console;
use crate::failure::Failure;

/// The families of blocks, in the order in which they are listed.
const FAMILIES: [(&str, &[Kind]); 8] = [
    ("Cameras", &[Kind::Camera]),
    ("Surroundings and settings", &[Kind::Settings, Kind::Animation, Kind::Background, Kind::Fog]),
    ("Lights", &[Kind::Lights, Kind::Light]),
    ("Materials", &[Kind::Materials, Kind::Material]),
    ("Textures", &[Kind::Textures, Kind::Texture]),
    ("Media", &[Kind::Media, Kind::Medium]),
    ("Objects", &[Kind::Group, Kind::Define, Kind::Transform, Kind::Instance, Kind::Shape]),
    ("Within other blocks", &[Kind::Part, Kind::Picture]),
];

/// Columns of a terminal that a table fills, blanks before a column, and what its first columns have at most.
const WIDTH: usize = 100;
const GAP: usize = 2;
const WIDEST: [usize; 4] = [24, 30, 22, WIDTH];

/// `kajo help`, of a command or of a block.
///
/// # Errors
/// When there is neither of that name, or the answer cannot be written.
pub fn help(args: &HelpArgs) -> Result<(), Failure> {
    let mut command = Cli::tree();
    let Some((first, rest)) = args.topic.split_first() else {
        return console::answer(&format!("{}\n{}", command.render_long_help(), list()));
    };
    if command.find_subcommand(first).is_none()
        && let Some(block) = block_of(first).filter(|_| rest.is_empty())
    {
        return console::answer(&table(block));
    }
    for word in &args.topic {
        let Some(found) = command.find_subcommand(word).cloned() else { return Err(unknown(word)) };
        command = found;
    }
    console::answer(&command.render_long_help().to_string())
}

fn unknown(word: &str) -> Failure {
    let tree = Cli::tree();
    let commands = tree.get_subcommands().map(clap::Command::get_name);
    let near = nearest(word, commands.chain(blocks().map(|block| block.keyword)));
    let advice = match near {
        Some(near) => format!("did you mean `{near}`?"),
        None => "`kajo help` lists what there is".to_owned(),
    };
    Failure::Input(format!("there is no command and no block `{word}`\n\n{advice}"))
}

/// All blocks by their families.
fn list() -> String {
    let mut text = "Blocks of the scene language; `kajo help BLOCK` lists the fields of one:\n".to_owned();
    for (name, kinds) in FAMILIES {
        text.push_str(&format!("\n  {name}\n"));
        for block in blocks().filter(|block| kinds.contains(&block.kind)) {
            text.push_str(&format!("    {:<22}{}\n", block.keyword, block.about));
        }
    }
    text
}

/// A block with its fields.
fn table(block: &Block) -> String {
    let head = format!("{}: {}\n", block.keyword, block.about);
    let cells =
        |field: &FieldSpec| [field.key.to_owned(), field.values(), field.absence(), field.about.to_owned()];
    let mut rows = vec![["field", "value", "default", "meaning"].map(str::to_owned)];
    rows.extend(block.fields().map(cells));
    let parts: String =
        block.parts.iter().map(|part| format!("  {}: {}\n", part.keyword, part.about)).collect();
    let parts = if parts.is_empty() { parts } else { format!("\nBlocks that may stand in it:\n{parts}") };
    if rows.len() == 1 {
        return format!("{head}\nIt has no fields of its own, and holds other blocks.\n{parts}");
    }
    let longest = |column: usize| rows.iter().map(|cells| cells[column].chars().count()).max().unwrap_or(0);
    let mut widths: [usize; 4] = std::array::from_fn(|column| longest(column).min(WIDEST[column]));
    let others: usize = widths[..3].iter().map(|width| width + GAP).sum();
    widths[3] = WIDTH.saturating_sub(others + GAP);
    rows.iter().fold(head + "\n", |text, cells| text + &row(cells, widths)) + &parts
}

/// The lines of a row, with what is too long for its column broken.
fn row(cells: &[String; 4], widths: [usize; 4]) -> String {
    let columns: [Vec<String>; 4] = std::array::from_fn(|i| wrapped(&cells[i], widths[i]));
    let height = columns.iter().map(Vec::len).max().unwrap_or(0);
    let mut text = String::new();
    for i in 0..height {
        let mut line = String::new();
        for (column, width) in columns.iter().zip(widths) {
            let part = column.get(i).map_or("", String::as_str);
            line.push_str(&" ".repeat(GAP));
            line.push_str(part);
            line.push_str(&" ".repeat(width.saturating_sub(part.chars().count())));
        }
        text.push_str(line.trim_end());
        text.push('\n');
    }
    text
}

/// The words of a text in lines of at most so many letters, if no word is longer.
fn wrapped(text: &str, width: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for word in text.split_whitespace() {
        match lines.last_mut() {
            Some(line) if line.chars().count() + 1 + word.chars().count() <= width => {
                line.push(' ');
                line.push_str(word);
            }
            _ => lines.push(word.to_owned()),
        }
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_block_is_in_a_family_and_has_a_table() {
        let list = list();
        for block in blocks() {
            assert!(list.contains(&format!("    {} ", block.keyword)), "{}", block.keyword);
            let table = table(block);
            assert!(block.fields().all(|field| table.contains(field.key)), "{table}");
            assert!(table.lines().all(|line| line.chars().count() <= WIDTH), "{table}");
        }
    }

    #[test]
    fn a_table_says_value_default_and_meaning() {
        let table = table(block_of("Fog").unwrap());
        let lines: Vec<&str> = table.lines().collect();
        assert_eq!(lines[0], "Fog: what fills the air, for the classic integrator");
        assert!(lines[2].starts_with("  field          value"), "{table}");
        assert!(lines[3].starts_with("  color          r g b"), "{table}");
        assert!(table.contains("  heightFalloff  number ≥ 0, 1/length  0"), "{table}");
    }

    #[test]
    fn topics_are_commands_first_and_misspelt_ones_are_told() {
        let asked =
            |topic: &[&str]| help(&HelpArgs { topic: topic.iter().map(|&word| word.to_owned()).collect() });
        assert_eq!(asked(&["bench", "rays"]), Ok(()));
        let told = |topic: &str| format!("{:?}", asked(&[topic]).unwrap_err());
        assert!(told("Principeld").contains("did you mean `Principled`?"));
        assert!(told("rneder").contains("did you mean `render`?"));
        assert!(told("nothing at all").contains("lists what there is"));
    }
}
