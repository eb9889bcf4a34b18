// The page itself: contents that show where one is, colours, tables that scroll, paper.

// The section at whose heading or within which the upper part of the window is.
function contents() {
  const nav = document.querySelector("nav"), unfold = nav.querySelector(".unfold");
  const links = Array.from(nav.querySelectorAll("a"));
  const sections = links.map((link) => document.getElementById(link.hash.slice(1)));
  const mark = () => {
    const line = 0.3 * window.innerHeight;
    const end = window.scrollY + window.innerHeight >= document.documentElement.scrollHeight - 2 && window.scrollY > 0;
    let at = end ? links.length - 1 : -1;
    for (let k = 0; !end && k < sections.length; k++) if (sections[k].getBoundingClientRect().top <= line) at = k;
    links.forEach((link, k) => {
      if (k === at) link.setAttribute("aria-current", "location"); else link.removeAttribute("aria-current");
    });
    unfold.textContent = at < 0 ? "Contents" : links[at].textContent;
    const {current, list} = {current: links[at], list: nav.querySelector("ul")};
    if (current && list.scrollHeight > list.clientHeight) {
      const above = current.offsetTop - list.offsetTop;
      if (above < list.scrollTop || above + 30 > list.scrollTop + list.clientHeight) list.scrollTop = above - 60;
    }
  };
  const open = (on) => {
    nav.classList.toggle("open", on);
    unfold.setAttribute("aria-expanded", on);
  };
  unfold.addEventListener("click", () => open(!nav.classList.contains("open")));
  nav.addEventListener("keydown", (event) => {
    if (event.key !== "Escape" || !nav.classList.contains("open")) return;
    open(false);
    unfold.focus();
  });
  links.forEach((link, k) => link.addEventListener("click", () => {
    open(false);
    const folded = sections[k].querySelector(":scope > details");
    if (folded) folded.open = true;
  }));
  let waiting = false;
  const soon = () => {
    if (waiting) return;
    waiting = true;
    requestAnimationFrame(() => { waiting = false; mark(); });
  };
  window.addEventListener("scroll", soon, {passive: true});
  window.addEventListener("resize", soon);
  mark();
}

// Dark or light: as the system says, unless the reader has chosen.
function colours() {
  const select = document.querySelector(".theme select");
  const remembered = (value) => {
    try { // a page in a frame of its own has no memory
      if (value === undefined) return localStorage.getItem("antenna-pin-colours") || "";
      localStorage.setItem("antenna-pin-colours", value);
    } catch (error) { /* then it is as the system says each time */ }
    return "";
  };
  const apply = (value) => {
    if (value) document.documentElement.dataset.theme = value;
    else delete document.documentElement.dataset.theme;
    window.dispatchEvent(new Event("ap-theme"));
  };
  select.value = remembered();
  apply(select.value);
  select.addEventListener("change", () => { remembered(select.value); apply(select.value); });
}

// A table that does not fit is scrolled sideways; only such a one shows that it can be.
function scrolled() {
  const boxes = Array.from(document.querySelectorAll(".scroll, .sheet"));
  const mark = (box) => {
    const more = box.scrollWidth - box.clientWidth - box.scrollLeft;
    box.classList.toggle("more", more > 1);
  };
  const all = () => boxes.forEach(mark);
  boxes.forEach((box) => box.addEventListener("scroll", () => mark(box), {passive: true}));
  document.querySelectorAll("details").forEach((part) => part.addEventListener("toggle", all));
  window.addEventListener("resize", all);
  all();
}

// Paper has what is folded for want of room on a screen, and light colours.
function paper() {
  let opened = [];
  window.addEventListener("beforeprint", () => {
    opened = Array.from(document.querySelectorAll("details.paper:not([open])"));
    opened.forEach((part) => { part.open = true; });
  });
  window.addEventListener("afterprint", () => {
    opened.forEach((part) => { part.open = false; });
    opened = [];
  });
}

document.documentElement.classList.add("js");
document.querySelectorAll(".pictures").forEach(tabs);
contents();
colours();
scrolled();
paper();
window.report = {ready: unpackPictures().then(scrolled), csv: csvOf};
