// The report is readable without this script. The script replaces the picture with the 3-D view, and opens
// folded parts for printing.
(() => {
  const host = document.getElementById("viewer");
  const written = document.getElementById("drawings")?.textContent;
  if (host && written) {
    /** @type {DrawingDocument} */
    const drawings = JSON.parse(written);
    try {
      // The layout that is recommended comes last.
      sweetspotViewer(host, drawings, { drawing: drawings.drawings.length - 1 });
    } catch (error) {
      console.warn(error);
    }
  }

  /** @type {HTMLDetailsElement[]} */
  let folded = [];
  addEventListener("beforeprint", () => {
    folded = [...document.querySelectorAll("details")].filter((details) => !details.open);
    for (const details of folded) details.open = true;
  });
  addEventListener("afterprint", () => {
    for (const details of folded) details.open = false;
  });
})();
