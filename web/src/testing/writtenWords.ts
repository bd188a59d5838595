import ts from "typescript";

/** Words on the page that stand in a source file instead of in the catalogue. */
export interface WrittenWords {
  readonly line: number;
  readonly words: string;
  /** Whether they certainly are shown or read out; else they only read like a label or a sentence. */
  readonly isShown: boolean;
}

/** Attributes and properties whose value is shown or read out. */
const SHOWN =
  /^(?:title|alt|label|placeholder|of|text|hint|action|reason|problem|note|stage|checking|fallback|textContent|aria-(?:label|description|valuetext|roledescription|placeholder))$/;
/** Attributes that are for the browser. */
const MARKUP = /^(?:\w*[cC]lass\w*|style|d|viewBox|data-(?!label).*|aria-keyshortcuts)$/;

const LETTERS = /\p{L}/u;
const TWO_WORDS = /\p{L}{2,}[,.:;]? \p{L}+/u;
const LABEL = /^\s*\p{Lu}\p{Ll}/u;

/**
 * Finds JSX text, the values of human-facing attributes and properties, and any other literal that reads as a label
 * (a capitalised word) or as a sentence (two words). A single lower-case word elsewhere could as well be a value of the
 * API: the pseudo-language finds those.
 */
export function writtenWords(name: string, source: string): WrittenWords[] {
  const kind = name.endsWith("x") ? ts.ScriptKind.TSX : ts.ScriptKind.TS;
  const file = ts.createSourceFile(name, source, ts.ScriptTarget.Latest, true, kind);
  const found: WrittenWords[] = [];
  const visit = (node: ts.Node, isShown: boolean): void => {
    if (isForDevelopers(node)) return;
    const words = wordsOf(node);
    if (words !== null && (isShown ? LETTERS : TWO_WORDS).test(words)) add(node, words, isShown);
    else if (words !== null && LABEL.test(words)) add(node, words, isShown);
    ts.forEachChild(node, (child) => visit(child, isShownAt(child, isShown)));
  };
  const add = (node: ts.Node, words: string, isShown: boolean) => {
    const line = file.getLineAndCharacterOfPosition(node.getStart(file)).line + 1;
    found.push({ line, words: words.trim(), isShown });
  };
  visit(file, false);
  return found;
}

/** Imports, types and markup. */
function isForDevelopers(node: ts.Node): boolean {
  return (
    ts.isImportDeclaration(node) ||
    ts.isExportDeclaration(node) ||
    ts.isTypeNode(node) ||
    (ts.isJsxAttribute(node) && MARKUP.test(node.name.getText())) ||
    (isAssignment(node) && MARKUP.test(assignedName(node)))
  );
}

/** A literal's words, with `…` for what is filled in; null for any other node. */
function wordsOf(node: ts.Node): string | null {
  if (ts.isJsxText(node) || ts.isStringLiteralLike(node)) return node.text;
  if (!ts.isTemplateExpression(node)) return null;
  return [node.head, ...node.templateSpans.map(({ literal }) => literal)]
    .map(({ text }) => text)
    .join("…");
}

/** Whether the value of `node` is shown, given whether that of its parent is. */
function isShownAt(node: ts.Node, isParentShown: boolean): boolean {
  const { parent } = node;
  if (ts.isJsxText(node)) return true;
  if (ts.isJsxExpression(node)) return isParentShown || isChild(node);
  if (ts.isJsxAttribute(node) || ts.isPropertyAssignment(node))
    return SHOWN.test(node.name.getText());
  if (isAssignment(node)) return SHOWN.test(assignedName(node));
  if (ts.isCallExpression(parent) && node === parent.arguments[1] && isSetAttribute(parent))
    return SHOWN.test(wordsOf(parent.arguments[0] ?? node) ?? "");
  const isChoice =
    ts.isConditionalExpression(node) ||
    ts.isBinaryExpression(node) ||
    ts.isParenthesizedExpression(node);
  return isParentShown && (isChoice || (wordsOf(node) !== null && !isCompared(node)));
}

function isChild({ parent }: ts.JsxExpression): boolean {
  return ts.isJsxElement(parent) || ts.isJsxFragment(parent);
}

function isSetAttribute({ expression }: ts.CallExpression): boolean {
  return /(?:^|\.)setAttribute$/.test(expression.getText());
}

function isAssignment(node: ts.Node): node is ts.BinaryExpression {
  return ts.isBinaryExpression(node) && node.operatorToken.kind === ts.SyntaxKind.EqualsToken;
}

function assignedName({ left }: ts.BinaryExpression): string {
  return ts.isPropertyAccessExpression(left) ? left.name.text : "";
}

function isCompared({ parent }: ts.Node): boolean {
  return ts.isBinaryExpression(parent) && /^[!=]==$/.test(parent.operatorToken.getText());
}
