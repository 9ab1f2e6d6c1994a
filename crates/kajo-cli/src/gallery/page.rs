//! The page of a gallery: one HTML file that needs nothing but the pictures beside it.

use std::fmt::Write;

use crate::progress::in_short;

/// What the page says about one picture.
#[derive(Clone, Debug)]
pub struct Card {
    pub name: String,
    pub scene: String,
    pub arguments: String,
    pub result: Result<Rendered, String>,
}

/// A picture that came into being.
#[derive(Clone, Debug)]
pub struct Rendered {
    /// Files beside the page, with `/` between folders; the main picture first.
    pub files: Vec<String>,
    pub size: [u32; 2],
    pub samples: u32,
    pub rays: u64,
    pub seconds: f64,
    /// Warnings.
    pub said: String,
}

const STYLE: &str = "
:root { color-scheme: light dark; --line: #8884; --dim: #777; --bad: #b3261e }
@media (prefers-color-scheme: dark) { :root { --dim: #999; --bad: #f2b8b5 } }
body { font: 15px/1.5 system-ui, sans-serif; margin: 2rem auto; max-width: 84rem; padding: 0 1rem }
main { display: grid; gap: 1.5rem; grid-template-columns: repeat(auto-fill, minmax(19rem, 1fr)) }
article { border: 1px solid var(--line); border-radius: .5rem; padding: .75rem; overflow: hidden }
article.wide { grid-column: 1 / -1 }
h2 { font-size: 1rem; margin: 0 0 .5rem; overflow-wrap: anywhere }
img { max-width: 100%; height: auto; display: block; margin-bottom: .25rem; background: #000 }
p { margin: .25rem 0; color: var(--dim); font-size: .85rem; overflow-wrap: anywhere }
pre { overflow-x: auto; color: var(--bad); font-size: .8rem }
.failed { border-color: var(--bad) }
";

/// The page of those pictures that are done.
///
/// * `wanted`: how many there will be
pub fn page(title: &str, cards: &[Card], wanted: usize) -> String {
    let failed = cards.iter().filter(|card| card.result.is_err()).count();
    let rendered = || cards.iter().filter_map(|card| card.result.as_ref().ok());
    let seconds: f64 = rendered().map(|picture| picture.seconds).sum();
    let rays: u64 = rendered().map(|picture| picture.rays).sum();
    let title = escaped(title);
    let done = if cards.len() < wanted { format!("{} of {wanted}", cards.len()) } else { wanted.to_string() };
    let mut html = format!(
        "<!doctype html>\n<html lang=\"en\">\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width\">\n<title>{title}</title>\n<style>{STYLE}</style>\n\
         <h1>{title}</h1>\n<p>{done} pictures, {failed} failed; {} rays in {seconds:.1} s</p>\n<main>\n",
        in_short(rays as f64)
    );
    for card in cards {
        html.push_str(&article(card));
    }
    html.push_str("</main>\n</html>\n");
    html
}

fn article(card: &Card) -> String {
    let name = escaped(&card.name);
    let mut html = match &card.result {
        Ok(picture) if picture.size[0] > 3 * picture.size[1] => "<article class=\"wide\"".to_owned(),
        Ok(_) => "<article".to_owned(),
        Err(_) => "<article class=\"failed\"".to_owned(),
    };
    let _ = writeln!(html, " id=\"{name}\">\n<h2>{name}</h2>");
    match &card.result {
        Ok(picture) => html.push_str(&pictures(&card.name, picture)),
        Err(message) => {
            let _ = writeln!(html, "<pre>{}</pre>", escaped(message));
        }
    }
    let _ = writeln!(
        html,
        "<p><code>{} {}</code></p>\n</article>",
        escaped(&card.scene),
        escaped(&card.arguments)
    );
    html
}

fn pictures(name: &str, picture: &Rendered) -> String {
    let mut html = String::new();
    for file in &picture.files {
        let (link, text) = (percent_encoded(file), escaped(file));
        let shown = if file.to_ascii_lowercase().ends_with(".png") {
            format!("<img src=\"{link}\" alt=\"{}\" loading=\"lazy\">", escaped(name))
        } else {
            text.clone()
        };
        let _ = writeln!(html, "<a href=\"{link}\" title=\"{text}\">{shown}</a>");
    }
    let [width, height] = picture.size;
    let _ = writeln!(
        html,
        "<p>{width} × {height}, {} sample{} a pixel, {} rays in {:.2} s</p>",
        picture.samples,
        if picture.samples == 1 { "" } else { "s" },
        in_short(picture.rays as f64),
        picture.seconds
    );
    html
}

/// The text with the characters that HTML gives a meaning replaced.
fn escaped(text: &str) -> String {
    let mut html = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => html.push_str("&amp;"),
            '<' => html.push_str("&lt;"),
            '>' => html.push_str("&gt;"),
            '"' => html.push_str("&quot;"),
            '\'' => html.push_str("&#39;"),
            c => html.push(c),
        }
    }
    html
}

/// The name of a file as a link [RFC 3986, 2.3].
fn percent_encoded(name: &str) -> String {
    let mut link = String::with_capacity(name.len());
    for byte in name.bytes() {
        match byte {
            b'A'..=b'Z' | b'a'..=b'z' | b'0'..=b'9' | b'-' | b'.' | b'_' | b'~' | b'/' => {
                link.push(byte.into())
            }
            byte => {
                let _ = write!(link, "%{byte:02X}");
            }
        }
    }
    link
}

#[cfg(test)]
mod tests {
    use super::*;

    fn card(name: &str, result: Result<Rendered, String>) -> Card {
        Card { name: name.into(), scene: "s.txt".into(), arguments: "-size 2 1".into(), result }
    }

    #[test]
    fn pictures_and_failures_are_shown() {
        let files = vec!["r1+r2 é.png".to_owned(), "x.exr".to_owned()];
        let rendered =
            Rendered { files, size: [2, 1], samples: 4, rays: 2500, seconds: 0.5, said: String::new() };
        let cards = [card("a", Ok(rendered)), card("b", Err("`<x>` & more".into()))];
        assert!(page("Ours", &cards[..1], 2).contains("1 of 2 pictures, 0 failed"));
        let html = page("<Ours>", &cards, 2);
        for part in [
            "<title>&lt;Ours&gt;</title>",
            "2 pictures, 1 failed; 2.5 k rays in 0.5 s",
            "<img src=\"r1%2Br2%20%C3%A9.png\"",
            "<a href=\"x.exr\" title=\"x.exr\">x.exr</a>",
            "<pre>`&lt;x&gt;` &amp; more</pre>",
            "<code>s.txt -size 2 1</code>",
        ] {
            assert!(html.contains(part), "{part} in {html}");
        }
        assert!(!html.contains("http"), "nothing from elsewhere");
    }
}
