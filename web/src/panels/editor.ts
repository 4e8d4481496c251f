// SPDX-License-Identifier: Apache-2.0
// The SPARQL editor, with completion from the map's own classes and properties. It asks nothing of any server.
import { Yasqe } from '@zazuko/yasqe';
import type { MapModel } from '../data/model';

const PREFIXES = {
  clx: 'https://w3id.org/cluxel/ontology#',
  map: 'https://w3id.org/cluxel/map/',
  geo: 'http://www.opengis.net/ont/geosparql#',
  sosa: 'http://www.w3.org/ns/sosa/',
  prov: 'http://www.w3.org/ns/prov#',
  skos: 'http://www.w3.org/2004/02/skos/core#',
  rdf: 'http://www.w3.org/1999/02/22-rdf-syntax-ns#',
  rdfs: 'http://www.w3.org/2000/01/rdf-schema#',
  xsd: 'http://www.w3.org/2001/XMLSchema#',
};

/** "clx:Tree" of a full IRI, where a known prefix fits. */
export function shortened(iri: string): string {
  for (const [prefix, namespace] of Object.entries(PREFIXES))
    if (iri.startsWith(namespace) && /^[\w/-]+$/.test(iri.slice(namespace.length)))
      return `${prefix}:${iri.slice(namespace.length)}`;
  return iri;
}

/** What CodeMirror's tokens hold; yasqe's own types leave it out. */
interface EditorToken { string: string }

const textOf = (token: unknown): string => (token as EditorToken | undefined)?.string.trim() ?? '';

function addCompleter(name: string, words: string[]): void {
  Yasqe.registerAutocompleter({
    name,
    bulk: false,
    autoShow: false,
    persistenceId: undefined,
    isValidCompletionPosition: (yasqe) => !/^["'?$#]/.test(textOf(yasqe.getCompleteToken())),
    preProcessToken: (_yasqe, token) => ({ ...token, autocompletionString: textOf(token) }),
    get: (_yasqe, token) => {
      const typed = textOf(token).toLowerCase();
      const bare = typed.slice(typed.indexOf(':') + 1);
      return words.filter((word) => word.toLowerCase().startsWith(typed) || word.slice(word.indexOf(':') + 1).toLowerCase().startsWith(bare))
        .slice(0, 60);
    },
    postProcessSuggestion: (_yasqe, _token, suggested) => suggested,
  }, false);
}

export class Editor {
  private readonly yasqe: Yasqe;

  constructor(host: HTMLElement, model: MapModel, onRun: () => void, onChange: () => void) {
    const words = [...model.classes.keys(), ...model.values.properties.map((property) => property.iri)];
    addCompleter('map', [...new Set(words.map(shortened))].sort());
    this.yasqe = new Yasqe(host, {
      persistenceId: null,
      createShareableLink: undefined,
      consumeShareLink: null,
      showQueryButton: false,
      resizeable: false,
      pluginButtons: undefined,
      prefixCcApi: null,
      autocompleters: ['variables', 'map'],
      lineNumbers: false,
      foldGutter: false,
      gutters: [],
      collapsePrefixesOnLoad: false,
      lineWrapping: true,
      editorHeight: '190px',
      screenReaderLabel: 'Question in SPARQL',
      extraKeys: { 'Ctrl-Enter': onRun, 'Cmd-Enter': onRun, 'Ctrl-Space': () => this.yasqe.autocomplete(),
                   Esc: () => this.yasqe.getInputField().blur(), Tab: false, 'Shift-Tab': false },
    } as never);
    this.yasqe.on('change', onChange);
  }

  get text(): string {
    return this.yasqe.getValue();
  }

  set text(value: string) {
    this.yasqe.setValue(value);
  }

  /** Puts the cursor at a place, counted from 1, and shows it. */
  pointTo(line: number, column: number): void {
    (this.yasqe.getWrapperElement().closest('details') as HTMLDetailsElement | null)?.setAttribute('open', '');
    this.yasqe.setCursor(line - 1, column - 1);
    this.yasqe.scrollIntoView(null, 30);
  }

  /** The editor measures itself only while it is seen. */
  refresh(): void {
    this.yasqe.refresh();
  }
}
